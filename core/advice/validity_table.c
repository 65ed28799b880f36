#include "core/advice/validity_table.h"

#include "core/advice/layout.h"

#include <math.h>

#define NOTHING -INFINITY

#define BRIDGE  "Parts may bridge the opening, which a density cannot show."
#define BRIDGED                                                                                    \
    "Parts bridge this opening: solve it with the microscopic model. The throughput of a density " \
    "says nothing about it."
#define ARCHES                                                                                     \
    "Parts with corners lock face to face and arch before an opening: of boxes that queued the "   \
    "density model let 30 % too few to 12 % too many through, and 22 % too few to 39 % too many "  \
    "where the opening was less than 3 times as wide as the circle about a part. Solve it with "   \
    "the microscopic model, too."
#define LANE                                                                                       \
    "Parts bridge the mouth of a narrow lane for a while: of those behind deflectors at 60 "       \
    "degrees "                                                                                     \
    "and more the density model let 6 to 17 % too many through."
#define CROWDED                                                                                    \
    "Moving parts that come one by one do not lie as close as packed ones, and wait before the "   \
    "belt "                                                                                        \
    "then; of the density 4 to 12 % more came onto it."
#define FEW "A density says little about a few parts."
#define SHORT                                                                                      \
    "Parts whose centres reach the end of the domain are gone before they stand in the way of "    \
    "others: up to 29 % more pass than on a longer belt, and more than of the density."
#define STAGGERED                                                                                  \
    "Cargo has to cross the belt between them, which the density model lets it do too easily: it " \
    "let up to 54 % too much through."
#define TAIL                                                                                       \
    "The end of a heap is a few parts that slide along the deflectors: of them the density model " \
    "let 12 % too many through where the whole heap passed within 2 %."
#define CORNER  "Cargo collects in the corner that the deflector closes, and stays there."
#define AT_WALL "Cargo collects at such a wall."
#define RUBS                                                                                       \
    "Cargo collects at such a wall, and slides along it if the belt takes it on: friction on "     \
    "walls, which the density has none of, slows moving parts then. At 15 degrees 5 % more of "    \
    "them were on the belt."
#define COMMANDED                                                                                  \
    "Whether an eye is blocked depends on single parts and on gaps between them. Where eyes or "   \
    "merges commanded belts, cycles of the density model were 22 % too short to 31 % too long, "   \
    "its throughput was 21 % too low to 20 % too high, it kept up to 42 % too much on the line, "  \
    "and up to 11 % more than of moving parts went to the wrong side of diverters that sorted."
#define TOO_MANY_PIECES "Angles and openings of so many were not measured."
#define NEAR                                                                                       \
    "Parts that enter right before the deflector push others aside, and lie less close than "      \
    "others: of the density 13 % too few to 5 % too many passed, and 5 to 12 % too many lay "      \
    "before it."
#define BESIDE                                                                                     \
    "Beside such a feed cargo queues, or none comes: where it was full the density model let "     \
    "12 % too few to 19 % too many through, and none where parts still passed a closed corner."
#define SLIDES                                                                                     \
    "A queue that slides along a shallow deflector of little friction pushes through faster than " \
    "its belt, one of high friction more slowly: the density model let 14 % too few to 11 % too "  \
    "many through."
#define SMOOTH                                                                                     \
    "Parts that do not rub press out of a short queue less: the density model let up to 13 % too " \
    "many of them through."
#define ROUGH                                                                                      \
    "Very rough parts get out more easily than the density model says: it let 5 to 10 % too few "  \
    "through, and up to 28 % on a fast belt."
#define FAST_BELT_FULL                                                                             \
    "A fast belt pulls parts out of a steep opening, the rougher they are the more so: the "       \
    "density model let up to 13 % too few through."
#define LANE_QUEUE                                                                                 \
    "A short queue presses less into a lane: of parts that queued on 2 to 5 diameters the "        \
    "density model let 6 to 18 % too many through."
#define PUSHED                                                                                     \
    "Streams along two shallow deflectors push each other through faster than their belt: the "    \
    "density model let 7 to 12 % too few through."
#define NEXT_BELT                                                                                  \
    "Parts are pulled out of the opening by a faster belt, or pushed into what a slower one "      \
    "holds: the density model let 16 % too few to 21 % too many through."
#define SHORT_END                                                                                  \
    "An end that stands off its wall by less than half a part is taken for the wall: the density " \
    "model let 4 % too few to 18 % too many through."
#define QUEUE                                                                                      \
    "The rate of a full outlet depends on how much cargo waits: it rises by 5 to 18 % when "       \
    "moving parts queue "                                                                          \
    "on 66 diameters instead of 17, which was not found in experiments."
#define LONG_QUEUE                                                                                 \
    "A long queue presses more through: of parts that queued on 25 to 40 diameters the density "   \
    "model let 12 % too few to 4 % too many through."

// Ranges of a figure that no comparison of the model had; of one that says nothing about it; up to a value; of one value.
#define NEVER                                                                                      \
    {                                                                                              \
        NAN, NAN, NULL, NULL                                                                       \
    }
#define NEVER_AS(text)                                                                             \
    {                                                                                              \
        NAN, NAN, NULL, text                                                                       \
    }
#define ANY                                                                                        \
    {                                                                                              \
        NOTHING, INFINITY, NULL, NULL                                                              \
    }
#define UP_TO(maximum, above)                                                                      \
    {                                                                                              \
        NOTHING, maximum, NULL, above                                                              \
    }
#define WITHIN(minimum, maximum)                                                                   \
    {                                                                                              \
        minimum, maximum, NULL, NULL                                                               \
    }

// Columns: dispersive, congested, parts.
const validity_row validity_table[VALIDITY_FIGURE_COUNT] = {
    [VALIDITY_ANGLE] = { "deg",
                         "A deflector stands at",
                         " degrees to the belt",
                         " degrees",
                         NULL,
                         { { 30.0, 90.0,
                             "The density model lets cargo slide too slowly along a flat "
                             "deflector.",
                             CORNER },
                           { 10.0, 90.0, NULL, CORNER },
                           { 10.0, 90.0, NULL, CORNER } } },
    [VALIDITY_OPENING] = { "diameters",
                           "The narrowest opening is",
                           " part diameters wide",
                           " diameters",
                           NULL,
                           { { 2.9, 12.5, BRIDGE, NULL },
                             { 4.0, 9.0, BRIDGE, NULL },
                             { 4.0, INFINITY,
                               "Whether and how long parts bridge such an opening was not "
                               "compared.",
                               NULL } } },
    [VALIDITY_FUNNEL] = { "diameters",
                          "The narrowest opening of several deflectors is",
                          " part diameters wide",
                          " diameters",
                          NULL,
                          { { 2.9, 12.5, BRIDGE, NULL },
                            { 5.0, 10.0, BRIDGE, NULL },
                            { 6.0, INFINITY,
                              "Whether and how long parts bridge such an opening was not compared.",
                              NULL } } },
    [VALIDITY_LANE] = { "diameters",
                        "Beside a deflector that bends the narrowest opening is",
                        " part diameters wide",
                        " diameters",
                        NULL,
                        { ANY, { 5.0, INFINITY, LANE, NULL }, ANY } },
    [VALIDITY_STAGGER] = { "diameters",
                           "Where cargo queues, one deflector is downstream of the other by",
                           " part diameters",
                           " diameters",
                           NULL,
                           { ANY, UP_TO(0.5, STAGGERED), ANY } },
    [VALIDITY_FREE_ENDS] = { "deg",
                             "Where cargo queues, a deflector with two free ends stands at",
                             " degrees to the belt",
                             " degrees",
                             NULL,
                             { ANY,
                               UP_TO(
                                   60.0,
                                   "The density model let 8 to 15 % too few past the ends of such "
                                   "a deflector."),
                               ANY } },
    [VALIDITY_RUN_OUT] = { "diameters",
                           "Where cargo queues, the domain ends behind a deflector after",
                           " part diameters",
                           " diameters",
                           NULL,
                           { { 6.0, INFINITY, SHORT, NULL },
                             { 6.0, INFINITY, SHORT, NULL },
                             { 6.0, INFINITY, SHORT, NULL } } },
    [VALIDITY_NEXT_BELT] = { "diameters",
                             "Behind a deflector whose opening is full another belt begins "
                             "after",
                             " part diameters",
                             " diameters",
                             NULL,
                             { ANY, { 12.0, INFINITY, NEXT_BELT, NULL }, ANY } },
    [VALIDITY_SHORT_END] = { "diameters",
                             "The opening is full, and a deflector ends",
                             " part diameters off its wall",
                             " diameters",
                             NULL,
                             { ANY, { 0.5, INFINITY, SHORT_END, NULL }, ANY } },
    [VALIDITY_FUNNEL_ANGLE] = { "deg",
                                "The opening is full, and one of several deflectors stands at",
                                " degrees to the belt",
                                " degrees",
                                NULL,
                                { ANY, { 30.0, INFINITY, PUSHED, NULL }, ANY } },
    [VALIDITY_SLIDING] = { NULL,
                           "The opening is full, and the friction on a deflector at less "
                           "than 50 degrees is",
                           "",
                           "",
                           NULL,
                           { ANY, { 0.1, 0.4, SLIDES, SLIDES }, ANY } },
    [VALIDITY_FRICTION_FULL] = { NULL,
                                 "The opening is nearly full, and the friction of parts on parts "
                                 "is",
                                 "",
                                 "",
                                 NULL,
                                 { ANY, { 0.05, 0.6, SMOOTH, ROUGH }, ANY } },
    [VALIDITY_ACCELERATION_FULL] = { "diameters",
                                     "The opening is nearly full, and the fastest belt brings a "
                                     "part to its "
                                     "speed "
                                     "within",
                                     " part diameters",
                                     " diameters",
                                     NULL,
                                     { ANY, UP_TO(1.0, FAST_BELT_FULL), ANY } },
    [VALIDITY_LANE_QUEUE] = { "diameters",
                              "A lane is full, and cargo may queue before it on",
                              " part diameters of belt",
                              " diameters",
                              NULL,
                              { ANY, { 8.0, INFINITY, LANE_QUEUE, NULL }, ANY } },
    [VALIDITY_BESIDE] = { NULL,
                          "Cargo may queue, and the number of feeds that leave some of "
                          "their belt free is",
                          "",
                          "",
                          "feeds over the whole width of their belt",
                          { ANY, UP_TO(0.0, BESIDE), ANY } },
    [VALIDITY_BRIDGES] = { "%",
                           "Of queues before the narrowest opening",
                           " % stop for good within 1,000 parts",
                           "",
                           "openings at which at most 5 % do",
                           { UP_TO(5.0, BRIDGED), UP_TO(5.0, BRIDGED), ANY } },
    [VALIDITY_SWEPT] = { "diameters",
                         "Where deflectors move, the narrowest opening becomes",
                         " part diameters wide",
                         " diameters",
                         NULL,
                         { NEVER_AS("Parts may be caught or bridge the opening, which a density "
                                    "cannot show."),
                           NEVER_AS("Parts may be caught or bridge the opening, which a density "
                                    "cannot show."),
                           { 1.0, INFINITY, "Parts may be caught between deflector and wall.",
                             NULL } } },
    [VALIDITY_HEAP] = { "parts/diameter",
                        "The heap has",
                        " parts for each part diameter of the narrowest opening",
                        "",
                        NULL,
                        { UP_TO(62.0, "So much cargo fills the opening, and the density model lets "
                                      "it pass too fast."),
                          ANY, ANY } },
    [VALIDITY_WARM_UP] = { "s",
                           "The figures leave out what a heap that no feed follows does for",
                           " s",
                           "",
                           "heaps from their start on",
                           { UP_TO(0.0, TAIL), UP_TO(0.0, TAIL), ANY } },
    [VALIDITY_LOAD] = { "%",
                        "Feeds offer",
                        " % of what the narrowest opening passes when it is full",
                        " %",
                        NULL,
                        { UP_TO(100.0, "The density model lets a full opening pass 20 to 100 % too "
                                       "much: solve it with the closure congested."),
                          ANY, ANY } },
    [VALIDITY_FEED] = { "%",
                        "A feed offers",
                        " % of what the belt under it carries when it is packed",
                        " %",
                        NULL,
                        { UP_TO(80.0, CROWDED), UP_TO(80.0, CROWDED), ANY } },
    [VALIDITY_QUEUE] = { "diameters",
                         "The opening is full, and cargo may queue before it on",
                         " part diameters of belt",
                         " diameters",
                         NULL,
                         { UP_TO(33.0, QUEUE),
                           { 8.0, 24.0, NEAR, LONG_QUEUE },
                           UP_TO(17.0, QUEUE) } },
    [VALIDITY_PARTS] = { "parts",
                         "The number of parts is",
                         "",
                         "",
                         NULL,
                         { { 24.0, 640.0, FEW, NULL }, { 96.0, INFINITY, FEW, NULL }, ANY } },
    [VALIDITY_BATCH] = { "parts",
                         "The number of parts that arrive at once is",
                         "",
                         "",
                         NULL,
                         { NEVER, NEVER, ANY } },
    [VALIDITY_SPEED] = { "m/s",
                         "A belt runs at",
                         " m/s",
                         " m/s",
                         NULL,
                         { { 0.2, 0.8,
                             "The density model lets cargo pass too slowly at such a speed.",
                             NULL },
                           WITHIN(0.1, 4.0),
                           WITHIN(0.1, 0.6) } },
    [VALIDITY_ACCELERATION] = { "diameters",
                                "The fastest belt brings a part to its speed within",
                                " part diameters",
                                " diameters",
                                NULL,
                                { ANY,
                                  UP_TO(3.0, "On such a belt the density model let 14 % too few to "
                                             "12 % too many through."),
                                  UP_TO(0.8, NULL) } },
    [VALIDITY_SCHEDULES] = { NULL,
                             "The number of belts whose speed changes is",
                             "",
                             "",
                             "constant speeds alone",
                             { UP_TO(0.0, NULL), UP_TO(0.0, NULL), NEVER } },
    [VALIDITY_COMMANDS] = { NULL,
                            "The number of actions by photo eyes and of merges is",
                            "",
                            "",
                            "lines without them",
                            { NEVER, UP_TO(0.0, COMMANDED), ANY } },
    [VALIDITY_SINKS] = { NULL,
                         "The number of sinks is",
                         "",
                         " sinks",
                         NULL,
                         { NEVER, UP_TO(2.0, NULL), ANY } },
    [VALIDITY_BELTS] = { NULL,
                         "The number of belt velocities, of belts with arcs two each, is",
                         "",
                         "",
                         "one alone",
                         { UP_TO(1.0, NULL), UP_TO(2.0, NULL), ANY } },
    [VALIDITY_ARCS] = { NULL,
                        "The number of arcs, those of paths too, is",
                        "",
                        "",
                        "straight belts alone",
                        { UP_TO(0.0, NULL), UP_TO(2.0, NULL), UP_TO(0.0, NULL) } },
    [VALIDITY_CURVE] = { NULL,
                         "The radius of a curve is",
                         " widths of its belt",
                         " widths",
                         NULL,
                         { ANY, WITHIN(1.2, INFINITY), ANY } },
    [VALIDITY_CORNERING] = { "%",
                             "Turning on a curve takes",
                             " % of the friction of its belt",
                             " %",
                             NULL,
                             { ANY, UP_TO(23.0, NULL), ANY } },
    [VALIDITY_INCLINE] = { "deg",
                           "The incline of a belt is",
                           " degrees",
                           " degrees",
                           NULL,
                           { NEVER, WITHIN(-12.0, 12.0), NEVER } },
    [VALIDITY_TURN] = { "deg",
                        "The angle between two belts is",
                        " degrees",
                        " degrees",
                        NULL,
                        { NEVER, UP_TO(90.0, NULL), NEVER } },
    [VALIDITY_RATIO] = { NULL,
                         "The ratio of the speeds of two belts is",
                         "",
                         "",
                         NULL,
                         { NEVER, UP_TO(2.0, NULL), NEVER } },
    [VALIDITY_TRANSFER] = { "%",
                            "Feeds offer",
                            " % of what one of several belts carries",
                            " %",
                            NULL,
                            { NEVER,
                              UP_TO(90.0,
                                    "The density model lets a full transfer pass up to 12 % too "
                                    "little."),
                              UP_TO(100.0, "The cargo backs up at the transfer, where the rate "
                                           "depends on how parts push each other.") } },
    [VALIDITY_FALLS] = { NULL,
                         "The number of places at which cargo leaves the belts is",
                         "",
                         "",
                         NULL,
                         { NEVER_AS("It falls there, and is lost for the throughput."),
                           NEVER_AS("It falls there, and is lost for the throughput."),
                           NEVER_AS("It falls there, and is lost for the throughput.") } },
    [VALIDITY_PLATES] = { NULL,
                          "The number of deflectors is",
                          "",
                          "",
                          NULL,
                          { UP_TO(1.0,
                                  "The density model holds cargo back between two deflectors."),
                            UP_TO(2.0, NULL), ANY } },
    [VALIDITY_GUIDES] = { NULL,
                          "The number of guides along the belt is",
                          "",
                          "",
                          NULL,
                          { NEVER, UP_TO(2.0, NULL), ANY } },
    [VALIDITY_BENDS] = { NULL,
                         "The number of bends of a deflector is",
                         "",
                         "",
                         NULL,
                         { UP_TO(1.0, NULL), UP_TO(1.0, NULL), ANY } },
    [VALIDITY_PIECES] = { NULL,
                          "The number of straight pieces of the deflectors is",
                          "",
                          "",
                          "a few",
                          { UP_TO(LAYOUT_PIECES_MAX, TOO_MANY_PIECES),
                            UP_TO(LAYOUT_PIECES_MAX, TOO_MANY_PIECES),
                            UP_TO(LAYOUT_PIECES_MAX, TOO_MANY_PIECES) } },
    [VALIDITY_WALL] = { "deg",
                        "A belt runs against a wall at",
                        " degrees",
                        "",
                        "walls along the belt",
                        { UP_TO(0.0, AT_WALL), UP_TO(0.0, RUBS), ANY } },
    [VALIDITY_DIAMETER] = { "m",
                            "A part is",
                            " m across",
                            " m",
                            NULL,
                            { { 0.022, 0.036,
                                "The density model is not laid out for such small parts.",
                                "The density model is not laid out for such large parts." },
                              WITHIN(0.01, 0.6),
                              ANY } },
    [VALIDITY_SIZES] = { NULL,
                         "The ratio of the diameters of two kinds of parts is",
                         "",
                         "",
                         NULL,
                         { NEVER, UP_TO(1.9, NULL), NEVER } },
    [VALIDITY_MASS] = { "kg",
                        "A part has a mass of",
                        " kg",
                        " kg",
                        NULL,
                        { WITHIN(0.002, 0.064), WITHIN(0.0005, 250.0), ANY } },
    [VALIDITY_MASSES] = { NULL,
                          "The ratio of the masses of two kinds of parts is",
                          "",
                          "",
                          NULL,
                          { NEVER, UP_TO(8.0, NULL), NEVER } },
    [VALIDITY_SHAPE] = { "%",
                         "The share of parts that are no cylinders is",
                         " %",
                         "",
                         "cylinders alone",
                         { UP_TO(0.0, NULL), UP_TO(0.0, ARCHES),
                           NEVER_AS("Their contacts were compared with known answers, but not the "
                                    "rate of many of them through an opening, nor whether they "
                                    "tip or climb on each other. Where boxes queue, their arches "
                                    "come and go: a minute's rate scatters by up to 8 %, and "
                                    "contacts ten times as hard let 10 % fewer to 2 % more "
                                    "through.") } },
    [VALIDITY_TIPPING] = { NULL,
                           "The friction on the belt times height over width of a part is",
                           "",
                           "",
                           "parts that cannot tip on their belt",
                           { UP_TO(
                                 1.0,
                                 "The belt can tip such a part over, which a density cannot show."),
                             UP_TO(
                                 1.0,
                                 "The belt can tip such a part over, which a density cannot show."),
                             UP_TO(1.0, "The belt can tip such a part over; cylinders in the plane "
                                        "stay upright.") } },
    [VALIDITY_KINDS] = { NULL,
                         "The number of kinds of cargo is",
                         "",
                         "",
                         NULL,
                         { UP_TO(1.0, NULL), UP_TO(3.0, NULL), ANY } },
    [VALIDITY_PLATE_FRICTION] = { NULL,
                                  "The friction of parts on deflectors is",
                                  "",
                                  "",
                                  NULL,
                                  { WITHIN(0.1, 0.5), WITHIN(0.0, 0.8), WITHIN(0.16, 0.5) } },
    [VALIDITY_WALL_FRICTION] = { NULL,
                                 "The friction of parts on walls is",
                                 "",
                                 "",
                                 NULL,
                                 { WITHIN(0.0, 0.19), WITHIN(0.0, 0.8), WITHIN(0.0, 0.5) } },
    [VALIDITY_PART_FRICTION] = { NULL,
                                 "The friction of parts on parts is",
                                 "",
                                 "",
                                 NULL,
                                 { WITHIN(0.05, 0.5), WITHIN(0.0, 0.8), WITHIN(0.15, 0.5) } },
    [VALIDITY_BELT_FRICTION] = { NULL,
                                 "The friction of parts on belts is",
                                 "",
                                 "",
                                 NULL,
                                 { WITHIN(0.3, 1.0), WITHIN(0.15, 1.0), WITHIN(0.22, 1.0) } },
    [VALIDITY_SMOOTHING] = { "s/m",
                             "The friction of parts on belts rises with slip by",
                             " s/m",
                             " s/m",
                             NULL,
                             { WITHIN(10.0, 10.0), WITHIN(10.0, 10.0), WITHIN(10.0, 100.0) } },
    [VALIDITY_TREATMENT] = { NULL,
                             "The number of deflectors that are not sealed is",
                             "",
                             "",
                             "sealed ones alone",
                             { UP_TO(0.0, "In the density model cargo leaks through field, and "
                                          "piles up in the corners of wall."),
                               ANY, ANY } },
    [VALIDITY_CELL] = { "diameters",
                        "The edge of a cell is",
                        " part diameters",
                        " diameters",
                        NULL,
                        { { 0.1, 0.25, NULL,
                            "The density model lets cargo pass too slowly on a coarse grid." },
                          WITHIN(0.2, 0.42),
                          ANY } },
    [VALIDITY_CONSTANTS] = { NULL,
                             "The number of constants of the model with other values is",
                             "",
                             "",
                             NULL,
                             { NEVER, NEVER, NEVER } },
    [VALIDITY_MOTIONS] = { NULL,
                           "The number of obstacles that move is",
                           "",
                           "",
                           "obstacles that stand",
                           { UP_TO(0.0, NULL), UP_TO(0.0, NULL), NEVER } },
    [VALIDITY_SHIFTS] = { NULL,
                          "The number of obstacles that are shifted is",
                          "",
                          "",
                          "obstacles that stand or turn",
                          { UP_TO(0.0, "The density before a pusher is packed at once and leaves "
                                       "at its speed; parts are struck, slide and roll on."),
                            UP_TO(0.0, "The density before a pusher is packed at once and leaves "
                                       "at its speed; parts are struck, slide and roll on."),
                            NEVER } },
    [VALIDITY_OVERLAP] = { "%",
                           "Parts will overlap by",
                           " % of the smallest radius",
                           " %",
                           NULL,
                           { ANY, ANY,
                             UP_TO(5.0, "Parts so soft pass an opening faster than real ones: "
                                        "choose a smaller modulus_reduction.") } },
};

const char *const validity_words[] = {
    [VALIDITY_ANGLE] = "angle",
    [VALIDITY_OPENING] = "opening",
    [VALIDITY_FUNNEL] = "funnel",
    [VALIDITY_LANE] = "lane",
    [VALIDITY_STAGGER] = "stagger",
    [VALIDITY_FREE_ENDS] = "free_ends",
    [VALIDITY_RUN_OUT] = "run_out",
    [VALIDITY_NEXT_BELT] = "next_belt",
    [VALIDITY_SHORT_END] = "short_end",
    [VALIDITY_FUNNEL_ANGLE] = "funnel_angle",
    [VALIDITY_SLIDING] = "sliding",
    [VALIDITY_FRICTION_FULL] = "friction_full",
    [VALIDITY_ACCELERATION_FULL] = "acceleration_full",
    [VALIDITY_LANE_QUEUE] = "lane_queue",
    [VALIDITY_BESIDE] = "beside",
    [VALIDITY_BRIDGES] = "bridges",
    [VALIDITY_SWEPT] = "swept_opening",
    [VALIDITY_HEAP] = "heap",
    [VALIDITY_WARM_UP] = "heap_warmup",
    [VALIDITY_LOAD] = "load",
    [VALIDITY_FEED] = "feed",
    [VALIDITY_QUEUE] = "queue",
    [VALIDITY_PARTS] = "parts",
    [VALIDITY_BATCH] = "batch",
    [VALIDITY_SPEED] = "speed",
    [VALIDITY_ACCELERATION] = "acceleration",
    [VALIDITY_SCHEDULES] = "schedules",
    [VALIDITY_COMMANDS] = "commands",
    [VALIDITY_SINKS] = "sinks",
    [VALIDITY_BELTS] = "belts",
    [VALIDITY_ARCS] = "arcs",
    [VALIDITY_CURVE] = "curve",
    [VALIDITY_CORNERING] = "cornering",
    [VALIDITY_INCLINE] = "incline",
    [VALIDITY_TURN] = "turn",
    [VALIDITY_RATIO] = "speed_ratio",
    [VALIDITY_TRANSFER] = "transfer",
    [VALIDITY_FALLS] = "falls",
    [VALIDITY_PLATES] = "plates",
    [VALIDITY_GUIDES] = "guides",
    [VALIDITY_BENDS] = "bends",
    [VALIDITY_PIECES] = "pieces",
    [VALIDITY_WALL] = "wall",
    [VALIDITY_DIAMETER] = "diameter",
    [VALIDITY_SIZES] = "sizes",
    [VALIDITY_MASS] = "mass",
    [VALIDITY_MASSES] = "masses",
    [VALIDITY_SHAPE] = "shape",
    [VALIDITY_TIPPING] = "tipping",
    [VALIDITY_KINDS] = "kinds",
    [VALIDITY_PLATE_FRICTION] = "plate_friction",
    [VALIDITY_WALL_FRICTION] = "wall_friction",
    [VALIDITY_PART_FRICTION] = "part_friction",
    [VALIDITY_BELT_FRICTION] = "belt_friction",
    [VALIDITY_SMOOTHING] = "friction_smoothing",
    [VALIDITY_TREATMENT] = "treatment",
    [VALIDITY_CELL] = "cell",
    [VALIDITY_CONSTANTS] = "constants",
    [VALIDITY_MOTIONS] = "motions",
    [VALIDITY_SHIFTS] = "shifts",
    [VALIDITY_OVERLAP] = "overlap",
    [VALIDITY_FIGURE_COUNT] = NULL,
};
