#include "core/observe/quantiles.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

enum {
    MANTISSA_BITS = 8,
    DROPPED_BITS = 52 - MANTISSA_BITS,
    OCTAVES = 36,
    N_BINS = (OCTAVES << MANTISSA_BITS) + 1, // with that from 0 on
};

static const double lowest = 0x1p-14;

// Exponent and first bits of the mantissa: rises by 1 from bin to bin.
static uint64_t key_of(double x)
{
    uint64_t bits;

    memcpy(&bits, &x, sizeof bits);
    return bits >> DROPPED_BITS;
}

static size_t bin_of(double x)
{
    if (!(x >= lowest))
        return 0;
    const uint64_t bin = key_of(x) - key_of(lowest) + 1;
    return bin < N_BINS ? (size_t)bin : N_BINS - 1;
}

size_t quantiles_bins(void)
{
    return N_BINS;
}

double quantiles_border(size_t bin)
{
    const uint64_t bits = (key_of(lowest) + bin - 1) << DROPPED_BITS;
    double x;

    memcpy(&x, &bits, sizeof x);
    return bin == 0 ? 0.0 : x;
}

bf_status quantiles_init(quantiles *ret_q, bf_error *err)
{
    *ret_q = (quantiles){ .min = (double)INFINITY, .bins = memory_alloc(N_BINS, sizeof(double)) };
    if (ret_q->bins == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
    return BF_OK;
}

void quantiles_clear(quantiles *q)
{
    memset(q->bins, 0, N_BINS * sizeof *q->bins);
    *q = (quantiles){ .min = (double)INFINITY, .bins = q->bins };
}

void quantiles_copy(quantiles *to, const quantiles *from)
{
    double *bins = to->bins;

    memcpy(bins, from->bins, N_BINS * sizeof *bins);
    *to = *from;
    to->bins = bins;
}

void quantiles_fini(quantiles *q)
{
    memory_free(q->bins);
    *q = (quantiles){ .bins = NULL };
}

static void note(quantiles *q, double a, double b, double weight)
{
    q->weight += weight;
    q->sum += weight * (0.5 * (a + b));
    q->min = fmin(q->min, a);
    q->max = fmax(q->max, b);
}

void quantiles_add(quantiles *q, double x, double weight)
{
    note(q, x, x, weight);
    q->bins[bin_of(x)] += weight;
}

void quantiles_add_uniform(quantiles *q, double a, double b, double weight)
{
    const double low = fmin(a, b), high = fmax(a, b);
    const size_t last = bin_of(high);
    double from = low;

    note(q, low, high, weight);
    for (size_t bin = bin_of(low); bin < last; bin++) {
        const double to = quantiles_border(bin + 1);
        q->bins[bin] += weight * ((to - from) / (high - low));
        from = to;
    }
    q->bins[last] += high > low ? weight * ((high - from) / (high - low)) : weight;
}

double quantiles_mean(const quantiles *q)
{
    return q->weight > 0.0 ? q->sum / q->weight : (double)NAN;
}

double quantiles_at(const quantiles *q, double p)
{
    const double wanted = p * q->weight;
    double below = 0.0;
    size_t bin = 0;

    if (!(q->weight > 0.0))
        return (double)NAN;
    while (bin < N_BINS - 1 && below + q->bins[bin] < wanted)
        below += q->bins[bin++];
    const double from = quantiles_border(bin), part = (wanted - below) / q->bins[bin];
    return fmax(q->min, fmin(q->max, from + part * (quantiles_border(bin + 1) - from)));
}

typedef struct saved_bin {
    uint64_t bin;
    double weight;
} saved_bin;

void quantiles_save(const quantiles *q, checkpoint_writer *w)
{
    const double of_all[] = { q->weight, q->sum, q->min, q->max };
    uint64_t n = 0;

    for (size_t bin = 0; bin < N_BINS; bin++)
        n += q->bins[bin] != 0.0;
    checkpoint_write(w, of_all, sizeof of_all);
    checkpoint_write(w, &n, sizeof n);
    for (size_t bin = 0; bin < N_BINS; bin++) {
        const saved_bin saved = { bin, q->bins[bin] };
        if (saved.weight != 0.0)
            checkpoint_write(w, &saved, sizeof saved);
    }
}

bool quantiles_load(quantiles *q, checkpoint_reader *r)
{
    double of_all[4];
    saved_bin saved;
    uint64_t n;

    if (!checkpoint_read(r, of_all, sizeof of_all) || !checkpoint_read(r, &n, sizeof n))
        return false;
    q->weight = of_all[0], q->sum = of_all[1], q->min = of_all[2], q->max = of_all[3];
    memset(q->bins, 0, N_BINS * sizeof *q->bins);
    for (uint64_t k = 0; k < n; k++) {
        if (!checkpoint_read(r, &saved, sizeof saved) || saved.bin >= N_BINS)
            return false;
        q->bins[saved.bin] = saved.weight;
    }
    return true;
}
