#include "core/study/sobol.h"

#include "core/base/check.h"

enum { DEGREE_MAX = 7 };

// Of each dimension: the coefficients of its primitive polynomial as bits, and the first direction numbers m_1, m_2,
// ..., as many as its degree.
static const struct {
    uint8_t polynomial;
    uint8_t m[DEGREE_MAX];
} table[SOBOL_DIMENSIONS] = {
    { 1, { 0 } },
    { 3, { 1 } },
    { 7, { 1, 3 } },
    { 11, { 1, 3, 1 } },
    { 13, { 1, 1, 1 } },
    { 19, { 1, 1, 3, 3 } },
    { 25, { 1, 3, 5, 13 } },
    { 37, { 1, 1, 5, 5, 17 } },
    { 41, { 1, 1, 5, 5, 5 } },
    { 47, { 1, 1, 7, 11, 19 } },
    { 55, { 1, 1, 5, 1, 1 } },
    { 59, { 1, 1, 1, 3, 11 } },
    { 61, { 1, 3, 5, 5, 31 } },
    { 67, { 1, 3, 3, 9, 7, 49 } },
    { 91, { 1, 1, 1, 15, 21, 21 } },
    { 97, { 1, 3, 1, 13, 27, 49 } },
    { 103, { 1, 1, 1, 15, 7, 5 } },
    { 109, { 1, 3, 1, 15, 13, 25 } },
    { 115, { 1, 1, 5, 5, 19, 61 } },
    { 131, { 1, 3, 7, 11, 23, 15, 103 } },
};

uint32_t sobol_coordinate(uint64_t index, unsigned dimension)
{
    const uint64_t gray = index ^ index >> 1;
    uint32_t m[SOBOL_BITS], x = 0;

    BF_CHECK(dimension < SOBOL_DIMENSIONS && index >> SOBOL_BITS == 0);
    // m_1, m_2, ... by the recurrence m_k = 2 a_1 m_(k-1) ^ ... ^ 2^s m_(k-s) ^ m_(k-s); all 1 in the first dimension.
    const unsigned polynomial = table[dimension].polynomial;
    unsigned degree = 0;
    while (polynomial >> (degree + 1) != 0)
        degree++;
    for (unsigned k = 0; k < SOBOL_BITS; k++) {
        if (k < degree || degree == 0) {
            m[k] = degree == 0 ? 1 : table[dimension].m[k];
            continue;
        }
        m[k] = m[k - degree];
        for (unsigned j = 1; j <= degree; j++)
            if (polynomial >> (degree - j) & 1)
                m[k] ^= m[k - j] << j;
    }
    for (unsigned k = 0; k < SOBOL_BITS; k++)
        if (gray >> k & 1)
            x ^= m[k] << (SOBOL_BITS - 1 - k);
    return x;
}
