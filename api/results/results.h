/// The results of a run in the formats of files and resources (README of api has the list).
///
/// The command line and the daemon write their results through these functions only, so that both
/// give the same bytes.

#pragma once

#include "api/json/members.h"
#include "api/results/colormap.h"
#include "api/results/key_figures.h"
#include "api/results/kinds.h"
#include "api/results/picture.h"
#include "api/results/results_files.h"
#include "api/services.h"
#include "core/base/buffer.h"
#include "core/observe/frame.h"

/// Figures of a run that frames do not carry.
typedef struct results_timing {
    double wall_s;      ///< wall time spent solving, all attempts together
    uint32_t n_threads; ///< threads used
} results_timing;

/// The objects below as tables, for the document of the API.
extern const member_table results_curve_members;
extern const member_table results_columns_members; ///< no members: names are those of the columns
extern const member_table results_grid_members;
extern const member_table results_snapshot_members;
extern const member_table results_snapshot_item_members;
extern const member_table results_snapshots_members;
extern const member_table results_parts_members;
extern const member_table results_parts_layout_members;
extern const member_table results_eye_members;
extern const member_table results_action_members;
extern const member_table results_drive_members;
extern const member_table results_stop_members;
extern const member_table results_changes_members;
extern const member_table results_summary_members; ///< its tag is the model

/// Append curve.csv's header line, "t_s,<columns>\n".
BF_MUST_CHECK bf_status results_curve_csv_header(const char *columns, bf_buffer *out,
                                                 bf_error *err);

/// Append n lines "t,value,...\n" in full precision.
BF_MUST_CHECK bf_status results_curve_csv_rows(const double *t, const double *values, size_t n,
                                               size_t n_columns, bf_buffer *out, bf_error *err);

/// Append the curve as curve.csv has it: header and rows.
BF_MUST_CHECK bf_status results_curve_csv(const api_curve *curve, bf_buffer *out, bf_error *err);

/// Append the curve as JSON: {"t_s": [...], "columns": {"<id>": [...], ...}}.
BF_MUST_CHECK bf_status results_curve_json(const api_curve *curve, bf_buffer *out, bf_error *err);

/// Append a grid of n2 rows of n1 floats as a NumPy file (.npy version 1.0, little-endian, C order).
BF_MUST_CHECK bf_status results_npy(const float *rho, size_t n1, size_t n2, bf_buffer *out,
                                    bf_error *err);

/// Append what results_npy() or results_parts_npy() writes before the numbers, which follow as they stand in memory.
BF_MUST_CHECK bf_status results_npy_head(size_t n1, size_t n2, bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status results_parts_npy_head(const api_parts *parts, bf_buffer *out,
                                               bf_error *err);

/// Append a snapshot as JSON: {"n", "t_s", "peak", "mass", "origin_m", "cell_m", "shape", "density":
/// [[...], ...]}, a row of x1 each.
BF_MUST_CHECK bf_status results_snapshot_json(const float *rho, const bf_grid *grid,
                                              const api_snapshot *snapshot, bf_buffer *out,
                                              bf_error *err);

/// Append a snapshot as a matrix in CSV: a header "y_m/x_m,<x of the centres>", then for each row of
/// cells, the smallest y first, the y of its centres and its densities.
BF_MUST_CHECK bf_status results_snapshot_csv(const float *rho, const bf_grid *grid, bf_buffer *out,
                                             bf_error *err);

/// Append a picture as a PNG of 256 colours, from the levels that picture_draw() gave; t is the time.
BF_MUST_CHECK bf_status results_snapshot_png(const picture *p, const colormap *map,
                                             const uint8_t *levels, double t, bf_buffer *out,
                                             bf_error *err);

/// Append a snapshot as VTK ImageData (.vti): cell data `density`, float32, appended raw.
BF_MUST_CHECK bf_status results_snapshot_vti(const float *rho, const bf_grid *grid, double t,
                                             bf_buffer *out, bf_error *err);

/// Append the line of photo_eyes.csv, "t_s,photo_eye,state", that a change has, with the header where *out is empty;
/// nothing for a change that is none of a photo eye.
BF_MUST_CHECK bf_status results_photo_eyes_csv(const frame_change *c, bf_buffer *out,
                                               bf_error *err);

/// A photo eye's state that changed, and an action that was carried out.
typedef struct results_eye_change {
    double t;               ///< s
    char id[SCENE_ID_SIZE]; ///< of the photo eye
    uint32_t is_blocked;    ///< its state from then on
} results_eye_change;
typedef struct results_action {
    double t;                   ///< s
    uint64_t index;             ///< in the scenario's actions
    char target[SCENE_ID_SIZE]; ///< id of the belt, obstacle or feed
} results_action;

/// How the drive of an obstacle follows what it is told.
typedef struct results_drive {
    double t;               ///< s
    char id[SCENE_ID_SIZE]; ///< of the obstacle
    uint32_t state;         ///< plate_drive_state
    double turn_deg;        ///< of its path, counter-clockwise
    vec2 shift;             ///< of its path, m
} results_drive;

/// Whether a failure, a break or a merge stops a belt.
typedef struct results_stop {
    double t;               ///< s
    char id[SCENE_ID_SIZE]; ///< of the belt
    uint32_t state;         ///< belt_stops_cause
} results_stop;

/// What the photo eyes of a run saw and did, drives under load, and belts that failed, so far. Zero-initialise; results_changes_fini().
typedef struct results_changes {
    bf_buffer eyes;    ///< results_eye_change, in the order of their times
    bf_buffer actions; ///< results_action, same
    bf_buffer drives;  ///< results_drive, same
    bf_buffer stops;   ///< results_stop, same
} results_changes;

/// Read the changes of a stored run into the empty *changes. BF_ECORRUPT: an event is damaged.
BF_MUST_CHECK bf_status results_changes_read(const api_services *services, const char *id,
                                             results_changes *changes, bf_error *err);
void results_changes_fini(results_changes *changes);

/// Append photo_eyes.csv, its header also where no state changed, or the JSON of all:
/// {"changes": [{"t_s", "photo_eye", "state"}], "actions": [{"t_s", "action", "target"}],
///  "drives": [{"t_s", "obstacle", "state", "turn_deg"}], "belts": [{"t_s", "belt", "state"}], "is_cut": false}.
BF_MUST_CHECK bf_status results_changes_csv(const results_changes *changes, bf_buffer *out,
                                            bf_error *err);
BF_MUST_CHECK bf_status results_changes_json(const results_changes *changes, bf_buffer *out,
                                             bf_error *err);

/// Append the rows of parts as a NumPy file of doubles, as CSV ("part,x_m,..."; a part that has left
/// the domain is a line of nan), or as JSON: {"n", "t_s", "columns": [...], "parts": [[...], null]}
/// (null: left the domain). In scenarios with feeds rows begin with id and kind, and CSV with "id,kind,x_m,...".
BF_MUST_CHECK bf_status results_parts_npy(const double *rows, const api_parts *parts,
                                          bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status results_parts_csv(const double *rows, const api_parts *parts,
                                          bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status results_parts_json(const double *rows, const api_parts *parts,
                                           const api_snapshot *snapshot, bf_buffer *out,
                                           bf_error *err);

/// Append the parts that are in the domain as VTK PolyData (.vtp): a vertex each with point data
/// `velocity_m_s`, `heading_rad` (planar) or `quaternion_wxyz` (spatial), `spin_rad_s`, in scenarios with feeds
/// `id` and `kind`, and `part`, the number of its row; appended raw.
BF_MUST_CHECK bf_status results_parts_vtp(const double *rows, const api_parts *parts, double t,
                                          bf_buffer *out, bf_error *err);

/// Append a ParaView collection (.pvd) of one file a snapshot, with its time; names are relative, as
/// of results_files_name().
BF_MUST_CHECK bf_status results_series_pvd(const api_snapshot_list *list, results_files file,
                                           bf_buffer *out, bf_error *err);

/// Append snapshots.json: {"grid": {...}, "snapshots": [{"n", "t_s", "file", "peak", "mass"}]}; with
/// parts also "parts": {"rows", "columns": [...]}, and "parts_file" for each snapshot. run_id NULL:
/// files are named snapshots/NNNNNN.npy and parts/NNNNNN.npy; else "url" and "parts_url" are the
/// resources of that run. With kinds (NULL: without) also "kinds": [0, 1, ...].
BF_MUST_CHECK bf_status results_snapshots_json(const api_snapshot_list *list, const char *run_id,
                                               const part_kinds *kinds, bf_buffer *out,
                                               bf_error *err);

/// Append summary.json. scenario is the resolved document; figures are those at the end, n = 0: there are none.
BF_MUST_CHECK bf_status results_summary(run_model model, const char *scenario, size_t n_scenario,
                                        const frame_begin *begin, const frame_end *end,
                                        const key_figures *figures, const results_timing *timing,
                                        bf_buffer *out, bf_error *err);

/// Append the summary of a run whose results are those of another one: the other's, but with its own
/// scenario, a resolved document, and `cached`. BF_ECORRUPT: summary is none of results_summary().
BF_MUST_CHECK bf_status results_summary_cached(const char *summary, size_t n_summary,
                                               const char *scenario, size_t n_scenario,
                                               bf_buffer *out, bf_error *err);

/// Read a curve from CSV text (header "t_s,<id>,..." or "t_s,count"): the column named id, or the
/// first one if id is NULL. Arrays are appended to *t and *parts as doubles, and the line of each
/// sample to *lines (NULL: not wanted) as size_t. BF_EINPUT: err->pointer is "/line/<number>", from 1.
BF_MUST_CHECK bf_status results_read_curve_csv(const char *text, size_t n, const char *id,
                                               bf_buffer *t, bf_buffer *parts, bf_buffer *lines,
                                               bf_error *err);

/// Copy the name of the first column of a curve's CSV to ret_name (SCENE_ID_SIZE bytes). BF_EINPUT: as
/// above.
BF_MUST_CHECK bf_status results_read_curve_column(const char *text, size_t n, char *ret_name,
                                                  bf_error *err);
