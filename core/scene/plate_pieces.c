#include "core/scene/plate_pieces.h"

#include "core/scene/plate_schedule.h"

void plate_pieces_placed(const surroundings *around, const scene_obstacle *o, size_t k,
                         plate_displacement displacement, vec2 ret_corners[4])
{
    const surroundings_piece piece = surroundings_piece_of(around, o, k);
    const plate_pose pose = plate_pose_of(o, displacement);

    surroundings_piece_corners(&piece, ret_corners);
    for (int corner = 0; corner < 4; corner++)
        ret_corners[corner] = plate_pose_move(&pose, ret_corners[corner]);
}

bool plate_pieces_get(const surroundings *around, const scene_obstacle *o, size_t k,
                      vec2 ret_corners[4])
{
    double came;

    if (!plate_schedule_is_present(o, 0.0, &came))
        return false;
    plate_pieces_placed(around, o, k, plate_schedule_displacement(o, 0.0), ret_corners);
    return true;
}
