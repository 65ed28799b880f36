#include "core/study/cmaes.h"

#include "core/base/check.h"
#include "core/study/variates.h"

#include <math.h>

enum { D_MAX = CMAES_DIMENSIONS, JACOBI_SWEEPS = 30 };

static const double condition_max = 1e14;

// Names as in the source's table 1.
typedef struct constants {
    size_t lambda;
    size_t mu;
    double w[CMAES_POPULATION];
    double mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu;
    double chi; // expectation of |N(0, I)|
} constants;

size_t cmaes_population(size_t d)
{
    return 4 + (size_t)floor(3.0 * log((double)d));
}

// The sum of n weights, and mu_eff, the square of their sum by the sum of their squares.
static double sum_weights(const double *w, size_t n, double *ret_mu_eff)
{
    double sum = 0.0, squares = 0.0;

    for (size_t i = 0; i < n; i++) {
        sum += w[i];
        squares += w[i] * w[i];
    }
    *ret_mu_eff = sum * sum / squares;
    return sum;
}

// Table 1, (49)-(58).
static constants constants_of(size_t dimensions)
{
    const double d = (double)dimensions;
    constants k = { .lambda = cmaes_population(dimensions) };
    double mu_eff_minus;

    k.mu = k.lambda / 2;
    for (size_t i = 0; i < k.lambda; i++)
        k.w[i] = log(((double)k.lambda + 1.0) / 2.0) - log((double)i + 1.0);
    const double plus = sum_weights(k.w, k.mu, &k.mu_eff);
    const double minus = -sum_weights(k.w + k.mu, k.lambda - k.mu, &mu_eff_minus);
    k.c_sigma = (k.mu_eff + 2.0) / (d + k.mu_eff + 5.0);
    k.d_sigma = 1.0 + 2.0 * fmax(0.0, sqrt((k.mu_eff - 1.0) / (d + 1.0)) - 1.0) + k.c_sigma;
    k.c_c = (4.0 + k.mu_eff / d) / (d + 4.0 + 2.0 * k.mu_eff / d);
    k.c_1 = 2.0 / ((d + 1.3) * (d + 1.3) + k.mu_eff);
    k.c_mu = fmin(1.0 - k.c_1, 2.0 * (0.25 + k.mu_eff + 1.0 / k.mu_eff - 2.0) /
                                   ((d + 2.0) * (d + 2.0) + k.mu_eff));
    const double alpha_mu = 1.0 + k.c_1 / k.c_mu;
    const double alpha_eff = 1.0 + 2.0 * mu_eff_minus / (k.mu_eff + 2.0);
    const double alpha_definite = (1.0 - k.c_1 - k.c_mu) / (d * k.c_mu);
    const double scale = fmin(alpha_mu, fmin(alpha_eff, alpha_definite)) / minus;
    for (size_t i = 0; i < k.lambda; i++)
        k.w[i] *= i < k.mu ? 1.0 / plus : scale;
    k.chi = sqrt(d) * (1.0 - 1.0 / (4.0 * d) + 1.0 / (21.0 * d * d));
    return k;
}

cmaes cmaes_begin(uint64_t seed, size_t d)
{
    cmaes s = { .seed = seed, .d = d, .sigma = 0.3 };

    BF_CHECK(d >= 1 && d <= D_MAX);
    for (size_t i = 0; i < d; i++) {
        s.mean[i] = 0.5;
        s.c[i][i] = s.axes[i][i] = s.lengths[i] = 1.0;
    }
    return s;
}

static void draw(const cmaes *s, size_t item, double *ret_z)
{
    const variates_key key = {
        .seed = s->seed, .purpose = VARIATES_STEP, .set = s->generation, .item = item
    };

    for (size_t j = 0; j < s->d; j++)
        ret_z[j] = variates_normal(&key, j);
}

// y = B D z.
static void stretch(const cmaes *s, const double *z, double *ret_y)
{
    for (size_t i = 0; i < s->d; i++) {
        ret_y[i] = 0.0;
        for (size_t j = 0; j < s->d; j++)
            ret_y[i] += s->axes[i][j] * (s->lengths[j] * z[j]);
    }
}

// The coordinate of the cube that x stands for: x for 0 <= x <= 1, -x for -1 <= x <= 0, and so on with period 2.
static double reflect(double x)
{
    const double rest = fabs(remainder(x, 2.0));

    return fmin(rest, 1.0);
}

void cmaes_points(const cmaes *s, double *ret_points)
{
    const size_t d = s->d, lambda = cmaes_population(d);
    double z[D_MAX], y[D_MAX];

    for (size_t k = 0; k < lambda; k++) {
        draw(s, k, z);
        stretch(s, z, y);
        for (size_t i = 0; i < d; i++)
            ret_points[k * d + i] = reflect(s->mean[i] + s->sigma * y[i]);
    }
}

// p_sigma and p_c from z_w and y_w, the weighted means of the mu best; returns h_sigma, 0 or 1 (43)-(45).
static double update_paths(cmaes *s, const constants *k, const double *z_mean, const double *y_mean)
{
    double length = 0.0;

    for (size_t i = 0; i < s->d; i++) {
        // C^(-1/2) y_w = B z_w.
        double whitened = 0.0;
        for (size_t j = 0; j < s->d; j++)
            whitened += s->axes[i][j] * z_mean[j];
        s->sigma_path[i] = (1.0 - k->c_sigma) * s->sigma_path[i] +
                           sqrt(k->c_sigma * (2.0 - k->c_sigma) * k->mu_eff) * whitened;
        length += s->sigma_path[i] * s->sigma_path[i];
    }
    length = sqrt(length);
    const double begun = 1.0 - pow(1.0 - k->c_sigma, 2.0 * (double)(s->generation + 1));
    const double h = length / sqrt(begun) < (1.4 + 2.0 / ((double)s->d + 1.0)) * k->chi;
    for (size_t i = 0; i < s->d; i++)
        s->path[i] =
            (1.0 - k->c_c) * s->path[i] + h * sqrt(k->c_c * (2.0 - k->c_c) * k->mu_eff) * y_mean[i];
    s->sigma *= exp(k->c_sigma / k->d_sigma * (length / k->chi - 1.0));
    return h;
}

// Cyclic Jacobi rotations: a becomes diagonal, the columns of axes its eigenvectors.
static void rotate(double a[D_MAX][D_MAX], double axes[D_MAX][D_MAX], size_t d, size_t p, size_t q)
{
    const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
    const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;

    for (size_t k = 0; k < d; k++) {
        const double left = a[k][p], right = a[k][q];
        a[k][p] = c * left - s * right;
        a[k][q] = s * left + c * right;
    }
    for (size_t k = 0; k < d; k++) {
        const double left = a[p][k], right = a[q][k];
        a[p][k] = c * left - s * right;
        a[q][k] = s * left + c * right;
        const double old = axes[k][p];
        axes[k][p] = c * old - s * axes[k][q];
        axes[k][q] = s * old + c * axes[k][q];
    }
}

// Eigenvectors and roots of the eigenvalues of C. Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 8.5.
static void decompose(cmaes *s)
{
    const size_t d = s->d;
    double a[D_MAX][D_MAX];

    for (size_t i = 0; i < d; i++)
        for (size_t j = 0; j < d; j++) {
            a[i][j] = s->c[i][j];
            s->axes[i][j] = i == j;
        }
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        bool is_diagonal = true;
        for (size_t p = 0; p < d; p++)
            for (size_t q = p + 1; q < d; q++)
                if (fabs(a[p][q]) > 1e-17 * sqrt(fabs(a[p][p] * a[q][q]))) {
                    rotate(a, s->axes, d, p, q);
                    is_diagonal = false;
                }
        if (is_diagonal)
            break;
    }
    for (size_t i = 0; i < d; i++)
        s->lengths[i] = sqrt(fmax(a[i][i], 0.0));
}

// C from p_c and the steps y of all points, best first; negative weights by the length of z (46)-(47).
static void update_covariance(cmaes *s, const constants *k, double h,
                              double y[CMAES_POPULATION][D_MAX], const double *z_squares)
{
    const double d = (double)s->d;
    double sum = 0.0;

    for (size_t i = 0; i < k->lambda; i++)
        sum += k->w[i];
    const double stay = 1.0 + k->c_1 * (1.0 - h) * k->c_c * (2.0 - k->c_c) - k->c_1 - k->c_mu * sum;
    for (size_t i = 0; i < s->d; i++)
        for (size_t j = 0; j <= i; j++) {
            double c = stay * s->c[i][j] + k->c_1 * s->path[i] * s->path[j];
            for (size_t n = 0; n < k->lambda; n++)
                c += k->c_mu * k->w[n] * (k->w[n] < 0.0 ? d / z_squares[n] : 1.0) * y[n][i] *
                     y[n][j];
            s->c[i][j] = s->c[j][i] = c;
        }
}

void cmaes_update(cmaes *s, const double *values)
{
    const constants k = constants_of(s->d);
    size_t order[CMAES_POPULATION];
    double z[D_MAX], y[CMAES_POPULATION][D_MAX], z_squares[CMAES_POPULATION] = { 0 };
    double z_mean[D_MAX] = { 0 }, y_mean[D_MAX] = { 0 };

    // The order of the points by their values; equal ones by their numbers.
    for (size_t i = 0; i < k.lambda; i++) {
        size_t at = i;
        for (; at > 0 && values[order[at - 1]] > values[i]; at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    for (size_t n = 0; n < k.lambda; n++) {
        draw(s, order[n], z);
        stretch(s, z, y[n]);
        for (size_t i = 0; i < s->d; i++) {
            z_squares[n] += z[i] * z[i];
            z_mean[i] += n < k.mu ? k.w[n] * z[i] : 0.0;
            y_mean[i] += n < k.mu ? k.w[n] * y[n][i] : 0.0;
        }
    }
    for (size_t i = 0; i < s->d; i++)
        s->mean[i] += s->sigma * y_mean[i];
    const double h = update_paths(s, &k, z_mean, y_mean);
    update_covariance(s, &k, h, y, z_squares);
    decompose(s);
    s->generation++;
}

bool cmaes_is_converged(const cmaes *s, double tolerance)
{
    double least = INFINITY, most = 0.0, deviation = 0.0;

    for (size_t i = 0; i < s->d; i++) {
        least = fmin(least, s->lengths[i]);
        most = fmax(most, s->lengths[i]);
        deviation = fmax(deviation, s->sigma * sqrt(s->c[i][i]));
    }
    return deviation < tolerance || most * most > condition_max * least * least;
}
