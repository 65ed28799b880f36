#include "tests/bench/box2d_jam.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <box2d/box2d.h>

// Box2D lets contacts overlap by b2_linearSlop, 0.005 units of length, whatever the size of a body: in
// centimetres 0.05 mm.
static const double units = 100.0; // per metre

// Pieces of a wall have this length. The broad phase knows a piece by the box around it, and that of a whole oblique
// plate would hold most of the jam.
static const double piece_radii = 10.0;

struct box2d_jam {
    box2d_jam_def def;
    b2World world{ b2Vec2_zero };
    std::vector<b2Body *> disks{};
};

static b2Vec2 in_units(const double *place)
{
    return { float(units * place[0]), float(units * place[1]) };
}

box2d_jam *box2d_jam_create(const box2d_jam_def *def)
{
    box2d_jam *j = new box2d_jam{ *def };

    j->world.SetAllowSleeping(false);     // the belt never stops
    j->world.SetContinuousPhysics(false); // no disk goes as far as its radius in a step
    return j;
}

void box2d_jam_destroy(box2d_jam *j)
{
    delete j;
}

void box2d_jam_add_disk(box2d_jam *j, double x, double y)
{
    const double place[] = { x, y };
    b2CircleShape shape;
    b2BodyDef body;
    b2FixtureDef fixture;

    body.type = b2_dynamicBody;
    body.position = in_units(place);
    body.linearVelocity = in_units(j->def.belt_velocity);
    body.linearDamping = body.angularDamping = float(j->def.damping);
    shape.m_radius = float(units * j->def.radius);
    fixture.shape = &shape;
    fixture.density = 1.0f;
    fixture.friction = float(j->def.friction);
    j->disks.push_back(j->world.CreateBody(&body));
    j->disks.back()->CreateFixture(&fixture);
}

void box2d_jam_add_wall(box2d_jam *j, size_t n, const double (*points)[2])
{
    std::vector<b2Vec2> path{ in_units(points[0]) };
    b2ChainShape shape;
    b2BodyDef body;
    b2FixtureDef fixture;

    for (size_t k = 1; k < n; k++) {
        b2Vec2 from = in_units(points[k - 1]), to = in_units(points[k]);
        const double piece = units * j->def.radius * piece_radii;
        const int n_pieces = std::max(1, int(b2Distance(from, to) / piece));
        for (int i = 1; i <= n_pieces; i++)
            path.push_back(from + float(i) / float(n_pieces) * (to - from));
    }
    const b2Vec2 first = path[0], last = path.back();
    shape.CreateChain(path.data(), int32(path.size()), 2.0f * first - path[1],
                      2.0f * last - path[path.size() - 2]);
    fixture.shape = &shape;
    // Box2D takes the geometric mean of both frictions.
    fixture.friction = float(j->def.wall_friction * j->def.wall_friction / j->def.friction);
    j->world.CreateBody(&body)->CreateFixture(&fixture);
}

// The factor by which a tanh(lambda |v|) slows a velocity v during dt, with v of the end of the step but in the tanh:
// it never reverses v.
static float slowing(double dt, double a, double lambda, float speed)
{
    return speed > 0.0f ? speed / (speed + float(dt * a) * std::tanh(float(lambda) * speed)) : 1.0f;
}

static void apply_belt(const box2d_jam_def &def, double dt, b2Body *disk)
{
    const b2Vec2 belt = in_units(def.belt_velocity), slip = disk->GetLinearVelocity() - belt;
    const float spin = disk->GetAngularVelocity();
    const float slip_slowing =
        slowing(dt, units * def.belt_deceleration, def.belt_tanh_linear / units, slip.Length());

    disk->SetLinearVelocity(belt + slip_slowing * slip);
    disk->SetAngularVelocity(
        slowing(dt, def.spin_deceleration, def.belt_tanh_spin, std::abs(spin)) * spin);
}

void box2d_jam_advance(box2d_jam *j, size_t n, const box2d_step *step)
{
    for (size_t k = 0; k < n; k++) {
        for (b2Body *disk : j->disks)
            apply_belt(j->def, step->dt, disk);
        j->world.Step(float(step->dt), step->n_velocity_iterations, step->n_position_iterations);
    }
}

size_t box2d_jam_count_before(const box2d_jam *j, double x)
{
    return size_t(std::count_if(j->disks.begin(), j->disks.end(), [x](const b2Body *disk) {
        return disk->GetPosition().x < float(units * x);
    }));
}

double box2d_jam_overlap(const box2d_jam *j)
{
    float least = 0.0f;

    for (const b2Contact *c = j->world.GetContactList(); c != nullptr; c = c->GetNext()) {
        b2WorldManifold manifold;
        c->GetWorldManifold(&manifold);
        for (int k = 0; k < c->GetManifold()->pointCount; k++)
            least = std::min(least, manifold.separations[k]);
    }
    return -double(least) / units;
}
