// Written by tests/validation/table.py: scenes that were solved for comparison, in the order of comparisons_columns.

#include "core/run/comparisons.h"

#include <math.h>

// clang-format off
const comparison_row comparisons_table[] = {
    { VALIDITY_CONGESTED, 0.0085, { 30, 30, 5.5, NAN, 126.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 30, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0059, { 45, 45, 4, NAN, 126.3, 20, 0.15, 0.19, 1, 0.3398, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 4 d; 24 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0299, { 45, 45, 7, NAN, 126.3, 20, 0.15, 0.19, 1, 0.04077, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 7 d; 200 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0117, { 60, 60, 3.5, NAN, 144.3, 20, 0.15, 0.19, 1, 0.01989, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 3.5 d; 410 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0364, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0172, { 60, 60, 8, NAN, 144.4, 20, 0.15, 0.19, 1, 0.8155, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 8 d; 10 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0445, { 75, 75, 4.5, NAN, 146.1, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 4.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0569, { 75, 75, 7, NAN, 146.1, 20, 0.15, 0.19, 1, 0.02718, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 7 d; 300 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0269, { 90, 90, 5, NAN, 159.5, 20, 0.15, 0.19, 1, 0.1989, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 5 d; 41 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0155, { 90, 90, 8, NAN, 159.6, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 8 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0274, { 50, 50, 6, NAN, 131.8, 20, 0.15, 0.19, 1, 0.01359, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 50, 6 d; 600 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0108, { 37, 37, 5, NAN, 126.3, 20, 0.15, 0.19, 1, 0.09594, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 37, 5 d; 85 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0372, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0/1
    { VALIDITY_CONGESTED, 0.0330, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.1, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.1/1
    { VALIDITY_CONGESTED, 0.0366, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.4, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.4/1
    { VALIDITY_CONGESTED, 0.0325, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.8, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.8/1
    { VALIDITY_CONGESTED, 0.0325, { 60, 60, 5.5, NAN, 144.4, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, 0.0226, { 60, 60, 5.5, NAN, 144.4, 20, 0.8, 0.5, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.8/0.5/1
    { VALIDITY_CONGESTED, 0.0515, { 60, 60, 5.5, NAN, 144.4, 20, 0.3, 0.3, 0.3, 0.4119, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.3/0.3/0.3
    { VALIDITY_CONGESTED, 0.0347, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 0.2, 0.6178, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/0.2
    { VALIDITY_CONGESTED, 0.0321, { 45, 45, 5.5, NAN, 126.3, 20, 0.3, 0.2, 0.5, 0.2471, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.3/0.2/0.5
    { VALIDITY_CONGESTED, -0.0263, { 75, 75, 5.5, NAN, 146.1, 20, 0.2, 0.35, 0.25, 0.4942, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0.2/0.35/0.25
    { VALIDITY_CONGESTED, 0.0710, { 45, 45, 5.5, NAN, 126.3, 20, 0.4, 0.4, 0.4, 0.3089, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.4/0.4/0.4
    { VALIDITY_CONGESTED, -0.0262, { 90, 90, 5.5, NAN, 159.6, 20, 0.1, 0.3, 0.6, 0.2059, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 5.5 d; 66 mm; 0.4 m/s; 0.1/0.3/0.6
    { VALIDITY_CONGESTED, -0.0342, { 75, 75, 5.5, NAN, 146.1, 20, 0.25, 0.12, 0.15, 0.8237, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0.25/0.12/0.15
    { VALIDITY_CONGESTED, -0.0267, { 75, 75, 5.5, NAN, 146.1, 20, 0, 0, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0/0/1
    { VALIDITY_CONGESTED, -0.0053, { 60, 60, 4, NAN, 144.4, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 4 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, -0.0208, { 60, 60, 9, NAN, 144.4, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 9 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, -0.0432, { 90, 90, 5.5, NAN, 159.6, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 5.5 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, -0.0357, { 75, 75, 7, NAN, 146.1, 20, 0.3, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 7 d; 66 mm; 0.4 m/s; 0.3/0.19/1
    { VALIDITY_CONGESTED, 0.0384, { 60, 60, 5.5, NAN, 144.4, 20, 0.3, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.3/0.19/1
    { VALIDITY_CONGESTED, -0.0074, { 60, 60, 8, NAN, 144.4, 20, 0.8, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 8 d; 66 mm; 0.4 m/s; 0.8/0.19/1
    { VALIDITY_CONGESTED, 0.0253, { 45, 45, 5.5, NAN, 126.3, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, 0.0091, { 30, 30, 6, NAN, 126.3, 20, 0.4, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 30, 6 d; 66 mm; 0.4 m/s; 0.4/0.19/1
    { VALIDITY_CONGESTED, 0.0334, { 60, 60, 6, NAN, 144.4, 20, 0.05, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 6 d; 66 mm; 0.4 m/s; 0.05/0.19/1
    { VALIDITY_CONGESTED, -0.0564, { 45, 45, 8, NAN, 126.3, 20, 0.05, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 8 d; 66 mm; 0.4 m/s; 0.05/0.19/1
    { VALIDITY_CONGESTED, 0.0297, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.007722, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.1 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0405, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.08495, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 24 mm; 0.2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0393, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.4942, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.8 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0266, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.7339, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 100 mm; 1.2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0149, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 3.089, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0084, { 60, 60, 5.5, NAN, 144.3, 20, 0.15, 0.19, 1, 0.002797, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 410 mm; 0.15 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0333, { 60, 60, 5.5, NAN, 144.3, 20, 0.15, 0.19, 1, 0.06116, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 300 mm; 0.6 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0353, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 2.124, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 24 mm; 1 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0276, { 60, 60, 4, NAN, 144.4, 20, 0.15, 0.19, 1, 3.089, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 4 d; 66 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0448, { 60, 60, 9, NAN, 144.4, 20, 0.15, 0.19, 1, 3.089, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 9 d; 66 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0532, { 75, 75, 6, NAN, 146.1, 20, 0.15, 0.19, 1, 1.738, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 6 d; 66 mm; 1.5 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0854, { 90, 90, 6, NAN, 159.6, 20, 0.15, 0.19, 1, 3.089, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 6 d; 66 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0126, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 4.827, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 2.5 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0927, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 9.46, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 3.5 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.1090, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 19.31, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 5 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.1191, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 77.22, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 10 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0648, { 60, 60, 9, NAN, 144.4, 20, 0.15, 0.19, 1, 9.46, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 9 d; 66 mm; 3.5 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.1432, { 90, 90, 7, NAN, 159.6, 20, 0.15, 0.19, 1, 6.95, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 7 d; 66 mm; 3 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0129, { 45, 45, 7, NAN, 126.3, 20, 0.15, 0.19, 0.2, 8.688, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 7 d; 66 mm; 1.5 m/s; 0.15/0.19/0.2
    { VALIDITY_CONGESTED, -0.0083, { 60, 60, NAN, 7, 144.4, 20, 0.15, 0.19, 1, 12.36, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 7 d; 66 mm; 4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0247, { 60, 60, 8, NAN, 144.4, 20, 0.15, 0.19, 1, 8.495, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 8 d; 24 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0700, { 30, 30, NAN, 6, 126.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 30, 6 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0247, { 45, 45, NAN, 5, 126.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 45, 5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0714, { 45, 45, NAN, 8, 126.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 45, 8 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0145, { 60, 60, NAN, 6, 144.4, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 6 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0301, { 60, 60, NAN, 9, 144.4, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 9 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0463, { 70, 70, NAN, 7, 145.5, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 70, 7 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0239, { 75, 75, NAN, 5.5, 146.1, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 75, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0332, { 80, 80, NAN, 5.5, 150.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 80, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0147, { 90, 90, NAN, 6, 159.6, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 90, 6 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0435, { 90, 90, NAN, 9, 159.6, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 90, 9 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0047, { 60, 60, NAN, 6, 144.4, 20, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 6 d; 66 mm; 0.4 m/s; 0.5/0.19/1
    { VALIDITY_CONGESTED, -0.0320, { 75, 75, NAN, 7, 146.1, 20, 0.4, 0.3, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 75, 7 d; 66 mm; 0.4 m/s; 0.4/0.3/1
    { VALIDITY_CONGESTED, -0.0011, { 60, 60, NAN, 6, 144.4, 20, 0.15, 0.19, 1, 3.089, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 6 d; 66 mm; 2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0564, { 80, 80, NAN, 8, 150.3, 20, 0.15, 0.19, 1, 1.112, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 80, 8 d; 66 mm; 1.2 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, -0.0241, { 80, 80, NAN, 8, 150.3, 20, 0.15, 0, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 80, 8 d; 66 mm; 0.4 m/s; 0.15/0/1
    { VALIDITY_CONGESTED, -0.0285, { 80, 80, NAN, 8, 150.3, 20, 0.15, 0.5, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 80, 8 d; 66 mm; 0.4 m/s; 0.15/0.5/1
    { VALIDITY_CONGESTED, 0.0276, { 60, 60, 5.5, NAN, 237.2, 8, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 2.3; foot 8
    { VALIDITY_CONGESTED, -0.0001, { 60, 60, 5.5, NAN, 237.2, 40, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 2.3; foot 40
    { VALIDITY_CONGESTED, 0.0098, { 75, 75, NAN, 7, 198.3, 8, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 75, 7 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 1.9; foot 8
    { VALIDITY_CONGESTED, -0.0975, { 75, 75, NAN, 7, 198.3, 40, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 75, 7 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 1.9; foot 40
    { VALIDITY_CONGESTED, -0.0004, { 60, 60, 5.5, NAN, 237.2, 40, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.5/0.19/1; load 2.3; foot 40
    { VALIDITY_CONGESTED, -0.0227, { 90, 90, 7, NAN, 216.6, 40, 0.15, 0.19, 1, 0.3398, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 7 d; 24 mm; 0.4 m/s; 0.15/0.19/1; load 1.9; foot 40
    { VALIDITY_CONGESTED, 0.0417, { 60, 60, 5.5, NAN, 237.2, 40, 0.15, 0.19, 1, 0.3398, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 24 mm; 0.4 m/s; 0.15/0.19/1; load 2.3; foot 40
    { VALIDITY_CONGESTED, -0.0760, { 75, 75, 5.5, NAN, 240, 40, 0.3, 0.19, 1, 0.04077, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 200 mm; 0.4 m/s; 0.3/0.19/1; load 2.3; foot 40
    { VALIDITY_CONGESTED, -0.0412, { 60, 60, NAN, 7, 195.9, 40, 0.5, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 60, 7 d; 66 mm; 0.4 m/s; 0.5/0.19/1; load 1.9; foot 40
    { VALIDITY_CONGESTED, -0.1101, { 45, 45, 5.5, NAN, 207.6, 40, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 2.3; foot 40
    { VALIDITY_CONGESTED, 0.0076, { 60, 60, 5.5, NAN, 41.25, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.4
    { VALIDITY_CONGESTED, -0.0031, { 60, 60, 5.5, NAN, 72.19, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.7
    { VALIDITY_CONGESTED, -0.0017, { 60, 60, 5.5, NAN, 87.66, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.85
    { VALIDITY_CONGESTED, 0.0035, { 45, 45, 5.5, NAN, 54.14, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.6
    { VALIDITY_CONGESTED, 0.0106, { 75, 75, 5.5, NAN, 93.94, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.9
    { VALIDITY_CONGESTED, 0.0032, { 90, 90, 5.5, NAN, 56.99, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 90, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.5
    { VALIDITY_CONGESTED, 0.0549, { 60, 60, 3.962, NAN, 291.5, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // free 60, 8 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0660, { 45, 45, 3.446, NAN, 256.6, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // free 45, 7 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0456, { 60, 60, 5.462, NAN, 145.4, 18.5, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, 2, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; turned 30
    { VALIDITY_CONGESTED, 0.0302, { 60, 60, 5.462, NAN, 145.4, 18.5, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, 2, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; turned 45
    { VALIDITY_CONGESTED, -0.0311, { 75, 75, 5.462, NAN, 147.1, 18.5, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, 2, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; turned 20
    { VALIDITY_CONGESTED, 0.0181, { 45, 45, 5.462, NAN, 127.2, 18.5, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, 2, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 45, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; turned 60
    { VALIDITY_CONGESTED, 0.0577, { 20, 20, NAN, 4, 126.3, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // lane 20, 4 d; 66 mm; 0.4 m/s; 0.15/0.19/1
    { VALIDITY_CONGESTED, 0.0264, { 15, 15, NAN, 6, 126.3, 20, 0.15, 0.3, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // lane 15, 6 d; 66 mm; 0.4 m/s; 0.15/0.3/1
    { VALIDITY_CONGESTED, 0.1140, { 30, 30, NAN, 5, 126.3, 20, 0.15, 0.1, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // lane 30, 5 d; 66 mm; 0.4 m/s; 0.15/0.1/1
    { VALIDITY_CONGESTED, 0.1276, { 30, 30, NAN, 3.5, 126.3, 20, 0.15, 0.3, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // lane 30, 3.5 d; 66 mm; 0.4 m/s; 0.15/0.3/1
    { VALIDITY_CONGESTED, -0.0140, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, 2, 95.29, 0, NAN, NAN, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // none 60, 14 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.55; ratio 0.5
    { VALIDITY_CONGESTED, 0.0011, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, 1.667, 57.75, 0, NAN, NAN, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // none 60, 14 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.4; ratio 0.6
    { VALIDITY_CONGESTED, -0.0035, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.3163, NAN, NAN, NAN, 1.6, 47.65, 0, 1, NAN, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; ratio 1.6
    { VALIDITY_CONGESTED, -0.0007, { 60, 60, 5.5, NAN, 144.4, 20, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, 1.429, 68.07, 0, 1, NAN, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; ratio 0.7
    { VALIDITY_CONGESTED, -0.0030, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, 90, NAN, 34.65, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 10 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.4
    { VALIDITY_CONGESTED, -0.0096, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, 90, NAN, 51.98, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 10 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.6
    { VALIDITY_CONGESTED, -0.0210, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, 90, 1.25, 86.63, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 10 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 0.8; ratio 0.8
    { VALIDITY_CONGESTED, -0.1198, { NAN, NAN, NAN, NAN, NAN, NAN, 0.15, 0.19, 1, 0.1236, NAN, NAN, 90, NAN, 86.63, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 10 d; 66 mm; 0.4 m/s; 0.15/0.19/1; load 1
    { VALIDITY_CONGESTED, -0.0042, { 60, 60, 3.667, NAN, 234.6, 13.33, 0.15, 0.19, 1, 0.08237, 1.5, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; sizes 1, 1.5
    { VALIDITY_CONGESTED, -0.0095, { 60, 60, 5.5, NAN, 107.5, 20, 0.15, 0.19, 1, 0.1236, 1.429, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; sizes 0.7, 1
    { VALIDITY_CONGESTED, -0.0559, { 60, 60, 3.056, NAN, 285.3, 11.11, 0.15, 0.19, 1, 0.06864, 1.8, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 3, NAN, NAN, NAN, NAN, NAN } }, // plate 60, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; sizes 1, 1.3, 1.8
    { VALIDITY_CONGESTED, -0.0126, { 75, 75, 4.583, NAN, 152, 16.67, 0.15, 0.19, 1, 0.103, 1.5, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 75, 5.5 d; 66 mm; 0.4 m/s; 0.15/0.19/1; sizes 0.8, 1.2
    { VALIDITY_CONGESTED, -0.0474, { 43, 43, 7.8, NAN, 126.3, 25, 0.22, 0.45, 0.79, 0.003299, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 43, 7.8 d; 440 mm; 0.15 m/s; 0.22/0.45/0.79; foot 25
    { VALIDITY_CONGESTED, -0.0327, { 87, 87, 7.8, NAN, 156.6, 14, 0.46, 0.76, 0.44, 2.188, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 87, 7.8 d; 41 mm; 0.88 m/s; 0.46/0.76/0.44; foot 14
    { VALIDITY_CONGESTED, 0.0157, { 65, 65, 5.6, NAN, 144.9, 40, 0.64, 0.59, 0.41, 0.5683, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 65, 5.6 d; 35 mm; 0.4 m/s; 0.64/0.59/0.41; foot 40
    { VALIDITY_CONGESTED, -0.0056, { 68, 68, 7.5, NAN, 145.3, 12, 0.61, 0.64, 0.76, 0.1491, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 68, 7.5 d; 190 mm; 0.65 m/s; 0.61/0.64/0.76; foot 12
    { VALIDITY_CONGESTED, 0.0120, { 65, 65, 4.5, NAN, 144.9, 20, 0.51, 0.39, 0.65, 0.2049, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 65, 4.5 d; 120 mm; 0.56 m/s; 0.51/0.39/0.65
    { VALIDITY_CONGESTED, 0.0062, { 51, 51, 7.8, NAN, 133, 9, 0.5, 0.56, 0.52, 0.2401, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 51, 7.8 d; 18 mm; 0.21 m/s; 0.5/0.56/0.52; foot 9
    { VALIDITY_CONGESTED, -0.0023, { 66, 66, 8.2, NAN, 145, 17, 0.56, 0.6, 0.62, 0.3296, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 66, 8.2 d; 11 mm; 0.21 m/s; 0.56/0.6/0.62; foot 17
    { VALIDITY_CONGESTED, -0.0594, { 89, 89, 3.6, NAN, 158.6, 14, 0.24, 0.18, 0.87, 0.006512, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 89, 3.6 d; 260 mm; 0.17 m/s; 0.24/0.18/0.87; foot 14
    { VALIDITY_CONGESTED, 0.1574, { 44, 44, 3.7, NAN, 126.3, 29, 0.79, 0.73, 0.72, 1.105, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 44, 3.7 d; 18 mm; 0.53 m/s; 0.79/0.73/0.72; foot 29
    { VALIDITY_CONGESTED, -0.1121, { 51, 51, 6.2, NAN, 132.9, 24, 0.73, 0.05, 0.26, 0.04103, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 51, 6.2 d; 430 mm; 0.3 m/s; 0.73/0.05/0.26; foot 24
    { VALIDITY_CONGESTED, -0.0256, { 84, 84, 6.7, NAN, 153.9, 27, 0.56, 0.78, 0.71, 0.1005, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 84, 6.7 d; 360 mm; 0.71 m/s; 0.56/0.78/0.71; foot 27
    { VALIDITY_CONGESTED, -0.0360, { 36, 36, 8.1, NAN, 126.3, 25, 0.24, 0.37, 0.3, 0.03306, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 36, 8.1 d; 74 mm; 0.12 m/s; 0.24/0.37/0.3; foot 25
    { VALIDITY_CONGESTED, 0.0127, { 44, 44, 7.7, NAN, 126.3, 30, 0.52, 0.3, 0.52, 1.853, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 44, 7.7 d; 64 mm; 1.1 m/s; 0.52/0.3/0.52; foot 30
    { VALIDITY_CONGESTED, -0.0632, { 71, 71, 5.8, NAN, 145.6, 14, 0.46, 0.09, 0.81, 1.12, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 71, 5.8 d; 68 mm; 1.1 m/s; 0.46/0.09/0.81; foot 14
    { VALIDITY_CONGESTED, 0.1233, { 68, 68, 4.8, NAN, 145.3, 31, 0.31, 0.6, 0.88, 5.957, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 68, 4.8 d; 14 mm; 1.2 m/s; 0.31/0.6/0.88; foot 31
    { VALIDITY_CONGESTED, 0.0415, { 58, 58, 4.8, NAN, 141.6, 21, 0.11, 0.43, 0.88, 0.1467, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // plate 58, 4.8 d; 43 mm; 0.33 m/s; 0.11/0.43/0.88; foot 21
    { VALIDITY_CONGESTED, -0.0346, { 68, 68, NAN, 8.3, 145.3, 13, 0.56, 0.45, 0.33, 0.03089, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 68, 8.3 d; 200 mm; 0.2 m/s; 0.56/0.45/0.33; foot 13
    { VALIDITY_CONGESTED, -0.0428, { 44, 44, NAN, 8.4, 126.3, 29, 0.5, 0.71, 0.35, 0.007664, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 44, 8.4 d; 190 mm; 0.1 m/s; 0.5/0.71/0.35; foot 29
    { VALIDITY_CONGESTED, -0.0154, { 32, 32, NAN, 9, 126.3, 40, 0.75, 0.75, 0.34, 0.03176, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 32, 9 d; 370 mm; 0.28 m/s; 0.75/0.75/0.34; foot 40
    { VALIDITY_CONGESTED, -0.0129, { 68, 68, NAN, 7, 145.3, 23, 0.17, 0.43, 0.57, 0.3286, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 68, 7 d; 48 mm; 0.42 m/s; 0.17/0.43/0.57; foot 23
    { VALIDITY_CONGESTED, 0.1264, { 59, 59, NAN, 3.6, 143, 28, 0.18, 0.34, 0.98, 0.4653, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 59, 3.6 d; 17 mm; 0.39 m/s; 0.18/0.34/0.98; foot 28
    { VALIDITY_CONGESTED, -0.0219, { 85, 85, NAN, 8.1, 154.8, 9, 0.66, 0.7, 0.72, 0.0236, NAN, NAN, NAN, NAN, NAN, 0, 2, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // funnel 85, 8.1 d; 120 mm; 0.2 m/s; 0.66/0.7/0.72; foot 9
    { VALIDITY_CONGESTED, -0.0330, { 62, 62, 4.239, NAN, 289.9, 21, 0.4, 0.37, 0.46, 0.2369, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // free 62, 8.5 d; 210 mm; 0.67 m/s; 0.4/0.37/0.46; foot 21
    { VALIDITY_CONGESTED, 0.0375, { 53, 53, 4.344, NAN, 274.2, 29, 0.31, 0.79, 0.49, 1.055, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // free 53, 8.8 d; 54 mm; 0.74 m/s; 0.31/0.79/0.49; foot 29
    { VALIDITY_CONGESTED, -0.0489, { NAN, NAN, NAN, NAN, NAN, NAN, 0.6, 0.57, 0.79, 0.3682, NAN, NAN, 90, 1.24, 78.83, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 7.6 d; 33 mm; 0.35 m/s; 0.6/0.57/0.79; load 0.91; ratio 1.24
    { VALIDITY_CONGESTED, -0.0104, { NAN, NAN, NAN, NAN, NAN, NAN, 0.41, 0.07, 0.66, 0.0492, NAN, NAN, 90, 1.07, 71.89, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 6.2 d; 46 mm; 0.16 m/s; 0.41/0.07/0.66; load 0.83; ratio 1.07
    { VALIDITY_CONGESTED, -0.0659, { NAN, NAN, NAN, NAN, NAN, NAN, 0.67, 0.77, 0.91, 2.352, NAN, NAN, 90, 1.38, 76.23, 0, NAN, 1, 2, 1, NAN, NAN, NAN, NAN, NAN } }, // transfer 60, 6.9 d; 18 mm; 0.63 m/s; 0.67/0.77/0.91; load 0.88; ratio 1.38
    { VALIDITY_CONGESTED, -0.0529, { 33, 33, 3.826, NAN, 203.4, 13.42, 0.62, 0.26, 0.32, 0.003696, 1.49, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 33, 5.7 d; 350 mm; 0.11 m/s; 0.62/0.26/0.32; sizes 1, 1.49
    { VALIDITY_CONGESTED, -0.0369, { 83, 83, 5.362, NAN, 222.3, 26.81, 0.53, 0.67, 1, 0.01498, 1.38, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 83, 7.4 d; 89 mm; 0.19 m/s; 0.53/0.67/1; sizes 1, 1.38; foot 37
    { VALIDITY_CONGESTED, -0.0160, { 83, 83, 3.613, NAN, 355.5, 6.806, 0.25, 0.32, 0.68, 0.01226, 1.91, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 2, NAN, NAN, NAN, NAN, NAN } }, // plate 83, 6.9 d; 200 mm; 0.25 m/s; 0.25/0.32/0.68; sizes 1, 1.91; foot 13
    { VALIDITY_PARTS_MODEL, -0.0041, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can
    { VALIDITY_PARTS_MODEL, 0.0025, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.09594, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // jar
    { VALIDITY_PARTS_MODEL, -0.0076, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.01119, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // keg
    { VALIDITY_PARTS_MODEL, 0.0010, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.3398, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // heavy disk
    { VALIDITY_PARTS_MODEL, 0.0116, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.3398, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // paper
    { VALIDITY_PARTS_MODEL, 0.0051, { 45, 45, 5.5, NAN, 135.4, 14.5, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can, 45 degrees
    { VALIDITY_PARTS_MODEL, -0.0045, { 90, 90, 5.5, NAN, 171, 21, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can, 90 degrees
    { VALIDITY_PARTS_MODEL, -0.0046, { 60, 60, 8, NAN, 154.7, 18.69, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can, 8 diameters
    { VALIDITY_PARTS_MODEL, -0.0033, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.05097, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // pill box
    { VALIDITY_PARTS_MODEL, 0.0053, { 60, 60, 6.5, NAN, 154.7, 17.82, 0.15, 0.19, 1, 0.3008, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // beer bottle
    { VALIDITY_PARTS_MODEL, 0.0016, { 70, 70, 6, NAN, 155.9, 18.82, 0.15, 0.19, 1, 0.1073, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // wine bottle
    { VALIDITY_PARTS_MODEL, -0.0047, { 60, 60, 5.5, NAN, 154.6, 17.25, 0.15, 0.19, 1, 0.04247, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // bucket
    { VALIDITY_PARTS_MODEL, 0.0000, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.003515, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // drum
    { VALIDITY_PARTS_MODEL, 0.0036, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.1973, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // coin
    { VALIDITY_PARTS_MODEL, 0.0099, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.15, 0.19, 1, 0.7722, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can at 1 m/s
    { VALIDITY_PARTS_MODEL, 0.0099, { 60, 60, 5.5, NAN, 154.7, 86.25, 0.15, 0.19, 1, 0.1236, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can, 120 widths of belt
    { VALIDITY_PARTS_MODEL, 0.0056, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.27, 0.27, 0.25, 0.4942, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can on acetal
    { VALIDITY_PARTS_MODEL, -0.0007, { 45, 45, 7, NAN, 135.4, 16, 0.27, 0.27, 0.25, 0.4942, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can on acetal, 45 degrees
    { VALIDITY_PARTS_MODEL, -0.0034, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.27, 0.27, 0.55, 0.2247, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // can on rubber
    { VALIDITY_PARTS_MODEL, 0.0025, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.245, 0.25, 0.25, 1.203, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // bottle on steel
    { VALIDITY_PARTS_MODEL, -0.0003, { 75, 75, 8, NAN, 156.5, 19.93, 0.245, 0.25, 0.22, 0.4361, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // jar on acetal, 75 degrees
    { VALIDITY_PARTS_MODEL, -0.0018, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.375, 0.265, 0.25, 1.977, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // PET bottle on acetal
    { VALIDITY_PARTS_MODEL, 0.0041, { 60, 60, 5.5, NAN, 154.7, 17.25, 0.27, 0.27, 0.27, 0.04144, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // keg on steel
    { VALIDITY_PARTS_MODEL, -0.0014, { 90, 90, 7, NAN, 170.9, 21, 0.3, 0.16, 0.45, 0.09439, NAN, NAN, NAN, NAN, NAN, 0, 1, NAN, 1, 1, NAN, NAN, NAN, NAN, NAN } }, // bucket on rubber, 90 degrees
};
// clang-format on

const size_t comparisons_table_n = sizeof comparisons_table / sizeof *comparisons_table;
