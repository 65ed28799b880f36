// The facts of goods.h. Where a source gives a range, the row has the range. What no source says is marked as
// assumed, with the reason.

#include "core/scene/goods.h"

// ---- goods

static const goods_source paper = {
    "Göttlich, Hoher, Schindler, Schleper, Verl: Applied Mathematical Modelling 38, 2014", NULL
};
static const goods_source weighed_cans = {
    "Lostmoon: Der Name der Dose (two cans, measured and weighed)",
    "http://lostmoon.de/der-name-der-dose-fortsetzung-1793"
};
static const goods_source can_500 = { "Yorkshire Escapes: 500 ml can dimensions",
                                      "https://www.yorkshire-escapes.com/post/24502" };
static const goods_source can_makers = {
    "Can Manufacturers Institute: dimensional food can standards",
    "http://www.cancentral.com/beverage-cans/standards"
};
static const goods_source bottle_sizes = {
    "Custom Glass Bottles: 500 ml bottles, 47 measured",
    "https://www.glasscraftbottle.com/glass-insights/sizeguides/1683.html"
};
static const goods_source preforms = { "Khimvolokno: bottle preforms of PET",
                                       "https://www.khimvolokno.by/en/products.asp?pr=901" };
static const goods_source din_6199 = { "DIN 6199, bottle of the shape Steinie",
                                       "https://de.wiki.li/Steinieform" };
static const goods_source longneck = {
    "The Cary Company: beer bottle dimensions (industry standard bottle)",
    "https://www.thecarycompany.com/insights/articles/beer-bottle-dimensions"
};
static const goods_source jars = { "Utility Great Britain: jam jars",
                                   "https://utilitygreatbritain.co.uk/products/jam-jars" };
static const goods_source crates = {
    "Verpackungs-Lexikon: Getränkekiste",
    "https://www.verpackungs-lexikon.com/html/getrankekiste.html"
};
static const goods_source vda_4500 = { "VDA 4500, small load carriers",
                                       "https://en.wikipedia.org/wiki/Euro_container" };
static const goods_source bucket = { "IOM: specification of a bucket, 14 l",
                                     "https://emergencymanual.iom.int/es/node/11291" };
static const goods_source din_kegs = { "Liquid Processing Equipment: kegs of DIN 6647",
                                       "http://www.liquidprocessingequipment.co.nz/beer-kegs-2/" };
static const goods_source euro_kegs = { "Dimensions Guide: draft beer keg size",
                                        "https://www.dimensionsguide.com/draft-beer-keg-size/" };
static const goods_source assumed = { "assumed", NULL };

const char *const scene_goods_words[SCENE_GOODS_COUNT + 1] = {
    [SCENE_PAPER_CYLINDER] = "paper-cylinder",
    [SCENE_CAN_330] = "can-330",
    [SCENE_CAN_500] = "can-500",
    [SCENE_FOOD_CAN_425] = "food-can-425",
    [SCENE_FOOD_CAN_850] = "food-can-850",
    [SCENE_PET_500] = "pet-500",
    [SCENE_PET_1500] = "pet-1500",
    [SCENE_GLASS_330] = "glass-330",
    [SCENE_GLASS_355] = "glass-355",
    [SCENE_GLASS_500] = "glass-500",
    [SCENE_JAR_440] = "jar-440",
    [SCENE_CARTON_240X180] = "carton-240x180",
    [SCENE_CARTON_300X200] = "carton-300x200",
    [SCENE_CARTON_400X300] = "carton-400x300",
    [SCENE_CARTON_600X400] = "carton-600x400",
    [SCENE_TRAY_24X330] = "tray-24x330",
    [SCENE_CRATE_20X500] = "crate-20x500",
    [SCENE_TOTE_300X200] = "tote-300x200",
    [SCENE_TOTE_400X300] = "tote-400x300",
    [SCENE_TOTE_600X400] = "tote-600x400",
    [SCENE_BUCKET_14] = "bucket-14",
    [SCENE_KEG_30] = "keg-30",
    [SCENE_KEG_50] = "keg-50",
    [SCENE_KEG_50_EMPTY] = "keg-50-empty",
};

#define ROUND(diameter, height)                                                                    \
    SCENE_CYLINDER,                                                                                \
    {                                                                                              \
        (diameter), (height)                                                                       \
    }
#define BOX(length, width, height)                                                                 \
    SCENE_BOX,                                                                                     \
    {                                                                                              \
        (length), (width), (height)                                                                \
    }
#define OF_PLAN                                                                                    \
    "length and width: a part of the module 600 x 400 mm; assumed: height, and 0.3 kg per liter"
#define FILLED                                                                                     \
    "mass assumed: a carrier that is filled halfway, at 0.3 kg per liter, and its own mass"

const goods_item goods_items[SCENE_GOODS_COUNT] = {
    [SCENE_PAPER_CYLINDER] = { "the paper's cylinder, with the paper's frictions",
                               ROUND(0.024, 0.008), 0.0, SCENE_SURFACE_COUNT, &paper,
                               "mass: steel, 7850 kg/m3" },
    [SCENE_CAN_330] = { "beverage can, 0.33 l, full", ROUND(0.066, 0.115), 0.382, SCENE_STEEL,
                        &weighed_cans, "" },
    [SCENE_CAN_500] = { "beverage can, 0.5 l, full", ROUND(0.066, 0.168), 0.52, SCENE_STEEL,
                        &can_500, "mass: 0.5 kg in a can of 20 g" },
    [SCENE_FOOD_CAN_425] = { "food can 300 x 407, full", ROUND(0.0762, 0.1127), 0.49, SCENE_STEEL,
                             &can_makers,
                             "mass: 15.22 oz of water; 0.06 kg of tinplate are assumed" },
    [SCENE_FOOD_CAN_850] = { "food can 401 x 411, full", ROUND(0.1032, 0.1191), 0.94, SCENE_STEEL,
                             &can_makers,
                             "mass: 29.79 oz of water; 0.1 kg of tinplate are assumed" },
    [SCENE_PET_500] = { "bottle of PET, 0.5 l, full", ROUND(0.07, 0.235), 0.52, SCENE_PET,
                        &bottle_sizes, "mass: 0.5 kg of water; 0.02 kg of bottle are assumed" },
    [SCENE_PET_1500] = { "bottle of PET, 1.5 l, full", ROUND(0.09, 0.32), 1.54, SCENE_PET,
                         &preforms,
                         "mass: 1.5 kg in a bottle of 40 g; assumed: diameter and height, 1.5 l "
                         "are 236 mm of such a cylinder below its neck" },
    [SCENE_GLASS_330] = { "bottle of glass, 0.33 l, full", ROUND(0.0705, 0.174), 0.6, SCENE_GLASS,
                          &din_6199, "mass: 0.33 kg in a bottle of 270 g" },
    [SCENE_GLASS_355] = { "bottle of glass, 12 fl oz, full", ROUND(0.061, 0.231), 0.56, SCENE_GLASS,
                          &longneck, "mass: 0.355 kg; 0.2 kg of glass are assumed" },
    [SCENE_GLASS_500] = { "bottle of glass, 0.5 l, full", ROUND(0.076, 0.264), 0.88, SCENE_GLASS,
                          &bottle_sizes,
                          "mass: 0.85 to 0.9 kg, Memim: beer bottle "
                          "(https://memim.com/beer-bottle.html)" },
    [SCENE_JAR_440] = { "jar of glass, 0.44 l, full", ROUND(0.082, 0.11), 0.66, SCENE_GLASS, &jars,
                        "diameter published; assumed: height, by the volume, and 0.22 kg of "
                        "glass" },
    [SCENE_CARTON_240X180] = { "carton, 240 x 180 x 120 mm", BOX(0.24, 0.18, 0.12), 1.6,
                               SCENE_CARDBOARD, &assumed,
                               "an example of a small parcel, 0.3 kg per liter" },
    [SCENE_CARTON_300X200] = { "carton, 300 x 200 x 150 mm", BOX(0.3, 0.2, 0.15), 2.7,
                               SCENE_CARDBOARD, &assumed, OF_PLAN },
    [SCENE_CARTON_400X300] = { "carton, 400 x 300 x 200 mm", BOX(0.4, 0.3, 0.2), 7.2,
                               SCENE_CARDBOARD, &assumed, OF_PLAN },
    [SCENE_CARTON_600X400] = { "carton, 600 x 400 x 300 mm", BOX(0.6, 0.4, 0.3), 21.6,
                               SCENE_CARDBOARD, &assumed, OF_PLAN },
    [SCENE_TRAY_24X330] = { "tray of cardboard with 24 cans of 0.33 l", BOX(0.396, 0.264, 0.117),
                            9.3, SCENE_CARDBOARD, &weighed_cans,
                            "six by four cans; 0.1 kg and 2 mm of cardboard are assumed" },
    [SCENE_CRATE_20X500] = { "bottle crate, 20 x 0.5 l, full", BOX(0.4, 0.3, 0.29), 19.4, SCENE_PE,
                             &crates,
                             "mass: 800 kg a pallet of 40; assumed: 25 kg of pallet, and the "
                             "height" },
    [SCENE_TOTE_300X200] = { "small load carrier 300 x 200 mm, filled", BOX(0.297, 0.198, 0.1475),
                             1.6, SCENE_PE, &vda_4500, FILLED },
    [SCENE_TOTE_400X300] = { "small load carrier 400 x 300 mm, filled", BOX(0.396, 0.297, 0.1475),
                             3.4, SCENE_PE, &vda_4500, FILLED },
    [SCENE_TOTE_600X400] = { "small load carrier 600 x 400 mm, filled", BOX(0.594, 0.396, 0.28),
                             12.5, SCENE_PE, &vda_4500, FILLED },
    [SCENE_BUCKET_14] = { "bucket of plastic, 14 l, full", ROUND(0.3, 0.3), 14.8, SCENE_PE, &bucket,
                          "the diameter is that of its rim; mass: 14 kg in a bucket of 0.78 kg" },
    [SCENE_KEG_30] = { "keg, 30 l, full", ROUND(0.381, 0.4), 39.0, SCENE_STEEL, &din_kegs,
                       "mass: 30 kg; 9 kg empty "
                       "(https://homediningkitchen.com/what-are-the-dimensions-of-a-30-litre-keg/"
                       ")" },
    [SCENE_KEG_50] = { "keg, 50 l, full", ROUND(0.408, 0.532), 62.5, SCENE_STEEL, &euro_kegs,
                       "mass: 50 kg; 12.5 kg empty are assumed, between 9 kg of 30 l and 13.5 kg "
                       "of 58.7 l" },
    [SCENE_KEG_50_EMPTY] = { "keg, 50 l, empty", ROUND(0.408, 0.532), 12.5, SCENE_STEEL, &euro_kegs,
                             "mass assumed, between 9 kg of 30 l and 13.5 kg of 58.7 l" },
};

// ---- surfaces

const char *const scene_surface_words[SCENE_SURFACE_COUNT + 1] = {
    [SCENE_STEEL] = "steel",   [SCENE_PE] = "pe",         [SCENE_PET] = "pet",
    [SCENE_GLASS] = "glass",   [SCENE_RUBBER] = "rubber", [SCENE_CARDBOARD] = "cardboard",
    [SCENE_WOOD] = "wood",     [SCENE_PVC] = "pvc",       [SCENE_PU] = "pu",
    [SCENE_ACETAL] = "acetal",
};

const char *const goods_surface_titles[SCENE_SURFACE_COUNT] = {
    [SCENE_STEEL] = "metal: steel, tinplate, aluminium; slats of steel",
    [SCENE_PE] = "polyethylene and polypropylene: crates, buckets, guide rails",
    [SCENE_PET] = "PET: bottles",
    [SCENE_GLASS] = "glass of containers, coated as usual",
    [SCENE_CARDBOARD] = "cardboard and paper",
    [SCENE_RUBBER] = "rubber: covers of belts, anti-slip mats",
    [SCENE_WOOD] = "wood",
    [SCENE_PVC] = "PVC: covers of belts",
    [SCENE_PU] = "polyurethane: covers of belts",
    [SCENE_ACETAL] = "acetal (POM): modular belts, table top chains",
};

// ---- frictions

static const goods_source tsubaki = {
    "Tsubakimoto: top chain selection, table 4 (dynamic friction of products on plastic, dry)",
    "https://tt-net.tsubakimoto.co.jp/tecs/engd/ctc/engd_ctc_sc_sen.asp?lang=en"
};
static const goods_source transdev = {
    "Transdev: plastics for chain guides, dynamic frictions",
    "https://www.transdev.co.uk/plastics/guide-rails/plastics-chain-guides-tag/"
};
static const goods_source lust = { "LUST: engineering guide CDA3000, table 7.21",
                                   "https://www.easymanua.ls/lust/cda3000/manual/691667?p=323" };
static const goods_source ctu = {
    "IMO/ILO/UNECE: CTU code, appendix 2, friction factors",
    "https://wiki.unece.org/display/TransportSustainableCTUCode/Appendix+2.%09Friction+factors"
};
static const goods_source physics = { "A table of frictions that names no origin",
                                      "https://blog.csdn.net/ldghd/article/details/8453306" };
static const goods_source pet_film = { "PET Film Supply: friction of PET film, ASTM D1894",
                                       "https://petfilmsupply.com/product/cof-of-pet-film/" };
static const goods_source pallets = { "Strauss et al.: SAE paper 2002-01-3104, pallets on hardwood",
                                      "http://www.impactinjuryanalysis.com/Credentials/Research/"
                                      "Reconstructing-Truck-Accident-Load-Shifting" };
static const goods_source mats = { "EN 12195-1, anti-slip mats, as printed by LoadLok",
                                   "https://www.loadlok.com/en/knowledge-base/"
                                   "the-coefficient-of-friction-of-materials-including-table" };
static const goods_source rubber_forum = { "finishing.com: rubber conveyor belt on steel idlers",
                                           "https://finishing.com/172/51.shtml" };

#define PLASTIC_BELT      "plastic belt on steel: 0.25 sliding, 0.25 to 0.45 static"
#define MATS              "0.6 static on any clean material; three quarters of it dynamic, by the CTU code"
#define LIKE_PAPER        "as a paper package on acetal; no table has this pair"
#define LIKE_PLASTIC      "as a plastic container on acetal; no table has this pair"
#define LIKE_GLASS        "as a glass bottle on acetal; no table has this pair"
#define LIKE_STEEL_ON_PVC "as steel on a plastic belt; no table has this pair"

const goods_friction goods_frictions[] = {
    { SCENE_STEEL, SCENE_STEEL, 0.22, 0.32, &transdev, "mild steel on mild steel" },
    { SCENE_STEEL, SCENE_PE, 0.12, 0.2, &transdev, "polyethylene (UHMW) on mild steel" },
    { SCENE_STEEL, SCENE_PET, 0.18, 0.35, &lust, "steel on plastic, sliding, dry" },
    { SCENE_STEEL, SCENE_GLASS, 0.2, 0.3, &physics,
      "glass on metal, static, lubricated, as coated containers are; clean 0.5 to 0.7" },
    { SCENE_STEEL, SCENE_CARDBOARD, 0.3, 0.3, &assumed, LIKE_PAPER },
    { SCENE_STEEL, SCENE_RUBBER, 0.5, 0.6, &rubber_forum, "dry, 20 to 50 degrees Celsius" },
    { SCENE_STEEL, SCENE_WOOD, 0.3, 0.6, &lust, "sliding, dry" },
    { SCENE_STEEL, SCENE_PVC, 0.25, 0.45, &lust, PLASTIC_BELT },
    { SCENE_STEEL, SCENE_PU, 0.5, 0.7, &transdev, "mild steel on polyurethane of 92 degrees" },
    { SCENE_STEEL, SCENE_ACETAL, 0.25, 0.25, &tsubaki, "cans of steel and aluminium; metal parts" },
    { SCENE_PE, SCENE_PE, 0.25, 0.35, &transdev, "polyethylene (UHMW) on itself" },
    { SCENE_PE, SCENE_PET, 0.25, 0.25, &assumed, LIKE_PLASTIC },
    { SCENE_PE, SCENE_GLASS, 0.22, 0.22, &assumed, LIKE_GLASS },
    { SCENE_PE, SCENE_CARDBOARD, 0.3, 0.3, &assumed, LIKE_PAPER },
    { SCENE_PE, SCENE_RUBBER, 0.45, 0.45, &mats, MATS },
    { SCENE_PE, SCENE_WOOD, 0.2, 0.24, &pallets, "dynamic; HDPE and LLDPE" },
    { SCENE_PE, SCENE_PVC, 0.25, 0.45, &assumed, LIKE_STEEL_ON_PVC },
    { SCENE_PE, SCENE_PU, 0.16, 0.26, &transdev,
      "polyethylene (UHMW) on polyurethane of 92 degrees" },
    { SCENE_PE, SCENE_ACETAL, 0.25, 0.25, &tsubaki, "plastic containers" },
    { SCENE_PET, SCENE_PET, 0.2, 0.55, &pet_film, "dynamic, film on film" },
    { SCENE_PET, SCENE_GLASS, 0.22, 0.22, &assumed, LIKE_GLASS },
    { SCENE_PET, SCENE_CARDBOARD, 0.3, 0.3, &assumed, LIKE_PAPER },
    { SCENE_PET, SCENE_RUBBER, 0.45, 0.45, &mats, MATS },
    { SCENE_PET, SCENE_WOOD, 0.2, 0.24, &assumed,
      "as polyethylene on wood; no table has this pair" },
    { SCENE_PET, SCENE_PVC, 0.25, 0.45, &assumed, LIKE_STEEL_ON_PVC },
    { SCENE_PET, SCENE_PU, 0.16, 0.26, &assumed,
      "as polyethylene on polyurethane; no table has this pair" },
    { SCENE_PET, SCENE_ACETAL, 0.25, 0.25, &tsubaki, "plastic containers" },
    { SCENE_GLASS, SCENE_GLASS, 0.09, 0.4, &physics,
      "sliding, lubricated to clean: containers are coated, and lose it" },
    { SCENE_GLASS, SCENE_CARDBOARD, 0.3, 0.3, &assumed, LIKE_PAPER },
    { SCENE_GLASS, SCENE_RUBBER, 0.45, 0.45, &mats, MATS },
    { SCENE_GLASS, SCENE_PVC, 0.25, 0.45, &assumed, LIKE_STEEL_ON_PVC },
    { SCENE_GLASS, SCENE_PU, 0.5, 0.7, &assumed,
      "as steel on polyurethane; no table has this pair" },
    { SCENE_GLASS, SCENE_ACETAL, 0.22, 0.22, &tsubaki, "glass bottles" },
    { SCENE_CARDBOARD, SCENE_CARDBOARD, 0.375, 0.375, &ctu,
      "0.5 static; three quarters of it dynamic" },
    { SCENE_CARDBOARD, SCENE_RUBBER, 0.45, 0.45, &mats, MATS },
    { SCENE_CARDBOARD, SCENE_WOOD, 0.375, 0.375, &ctu,
      "on wooden pallets, 0.5 static; three quarters of it dynamic" },
    { SCENE_CARDBOARD, SCENE_PVC, 0.25, 0.45, &assumed, LIKE_STEEL_ON_PVC },
    { SCENE_CARDBOARD, SCENE_PU, 0.16, 0.7, &assumed,
      "between polyethylene and steel on polyurethane; no table has this pair" },
    { SCENE_CARDBOARD, SCENE_ACETAL, 0.3, 0.3, &tsubaki, "paper packages" },
    { SCENE_RUBBER, SCENE_WOOD, 0.45, 0.45, &mats, MATS },
    { SCENE_RUBBER, SCENE_ACETAL, 0.45, 0.45, &mats, MATS },
    { SCENE_WOOD, SCENE_WOOD, 0.3, 0.5, &lust, "sliding, dry" },
    { SCENE_WOOD, SCENE_PVC, 0.25, 0.45, &assumed, LIKE_STEEL_ON_PVC },
    { SCENE_WOOD, SCENE_ACETAL, 0.3, 0.3, &assumed, LIKE_PAPER },
};
const size_t goods_n_frictions = sizeof goods_frictions / sizeof *goods_frictions;
