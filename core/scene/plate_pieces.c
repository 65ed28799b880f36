#include "core/scene/plate_pieces.h"

bf_status plate_pieces_init(plate_pieces *ret_pieces, const scene *s, bf_error *err)
{
    *ret_pieces = (plate_pieces){ .s = s, .around = surroundings_of(s) };
    return plate_motion_init(&ret_pieces->motion, s->n_obstacles, s->obstacles, err);
}

void plate_pieces_fini(plate_pieces *pieces)
{
    plate_motion_fini(&pieces->motion);
}

void plate_pieces_placed(const plate_pieces *pieces, size_t obstacle, size_t k,
                         plate_motion_place place, vec2 ret_corners[4])
{
    const surroundings_piece piece =
        surroundings_piece_of(&pieces->around, &pieces->s->obstacles[obstacle], k);
    const plate_motion_pose pose = plate_motion_pose_at(&pieces->motion, obstacle, place);

    surroundings_piece_corners(&piece, ret_corners);
    for (int corner = 0; corner < 4; corner++)
        ret_corners[corner] = plate_motion_move(&pose, ret_corners[corner]);
}

bool plate_pieces_get(const plate_pieces *pieces, size_t obstacle, size_t k, vec2 ret_corners[4])
{
    const plate_motion *motion = &pieces->motion;

    if (!plate_motion_is_present(motion, obstacle, 0.0))
        return false;
    plate_pieces_placed(pieces, obstacle, k, plate_motion_at(motion, obstacle, 0.0), ret_corners);
    return true;
}
