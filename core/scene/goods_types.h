/// Names of usual goods and of the surfaces that rub on each other; goods.h has what is known of them.

#pragma once

/// Goods by name. scene_goods_words has their names.
typedef enum scene_goods {
    SCENE_PAPER_CYLINDER,
    SCENE_CAN_330,
    SCENE_CAN_500,
    SCENE_FOOD_CAN_425,
    SCENE_FOOD_CAN_850,
    SCENE_PET_500,
    SCENE_PET_1500,
    SCENE_GLASS_330,
    SCENE_GLASS_355,
    SCENE_GLASS_500,
    SCENE_JAR_440,
    SCENE_CARTON_240X180,
    SCENE_CARTON_300X200,
    SCENE_CARTON_400X300,
    SCENE_CARTON_600X400,
    SCENE_TRAY_24X330,
    SCENE_CRATE_20X500,
    SCENE_TOTE_300X200,
    SCENE_TOTE_400X300,
    SCENE_TOTE_600X400,
    SCENE_BUCKET_14,
    SCENE_KEG_30,
    SCENE_KEG_50,
    SCENE_KEG_50_EMPTY,
    SCENE_GOODS_COUNT ///< goods of no name
} scene_goods;

/// What a surface is made of. scene_surface_words has their names.
typedef enum scene_surface {
    SCENE_STEEL,
    SCENE_PE,
    SCENE_PET,
    SCENE_GLASS,
    SCENE_CARDBOARD,
    SCENE_RUBBER,
    SCENE_WOOD,
    SCENE_PVC,
    SCENE_PU,
    SCENE_ACETAL,
    SCENE_SURFACE_COUNT ///< it is not said
} scene_surface;

extern const char *const scene_goods_words[SCENE_GOODS_COUNT + 1];     ///< the last is NULL
extern const char *const scene_surface_words[SCENE_SURFACE_COUNT + 1]; ///< the last is NULL

/// The surfaces that parts rub on.
typedef struct scene_surfaces {
    scene_surface
        conveyor; ///< of all belts (default SCENE_ACETAL where a kind of cargo has a surface)
    scene_surface handling; ///< of obstacles and walls (default SCENE_STEEL there)
} scene_surfaces;
