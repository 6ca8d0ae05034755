// The shared shadow grid against rays in double: its voxels, where it puts a shadow's edge, and what is made when.
#include "server/gpu/binding_sizes.h"
#include "tests/gpu/shadow_voxels.h"

namespace brume::test::shadow_grid_test {
namespace {

// Every voxel against rays in double, for the lights by slot.
void compareWithRays(const gpu::Device& device, const Scene& scene, bool coverage) {
    Gridded gridded(device, scene, glm::vec3(-4), glm::vec3(4));
    const uint64_t rays = gridded.recordAll();
    const gpu::ShadowGridBlock& shape = gridded.grid().shape();
    const std::vector<uint8_t> voxels = gridded.voxels();
    const reference::World world = reference::worldOf(scene, {});
    const reference::ObstacleTree tree(world.obstacles);
    ASSERT_EQ(shape.slots, 4u);
    EXPECT_EQ(shape.sun, 0u);
    const std::vector<reference::LightSource> lights{
        reference::directional(scene.lights[0]), reference::localLight(scene.lights[3]),
        reference::localLight(scene.lights[4]), reference::localLight(scene.lights[1])}; // by strength
    const auto isLit = [&](size_t slot, glm::dvec3 x) {
        const reference::Arrival arrival = reference::arrivalAt(lights[slot], x);
        return !tree.occluded({x, arrival.to_light, 0, arrival.distance});
    };
    const glm::uvec3 size = shape.bricks * 8u;
    uint64_t expected_rays = 0, compared = 0, lit = 0, solid = 0, wrong = 0, far_off = 0;
    const uint32_t step = coverage ? 3 : 1;
    for (uint32_t z = 0; z < size.z; z += step)
        for (uint32_t y = 0; y < size.y; y += step)
            for (uint32_t x = 0; x < size.x; x += step) {
                const size_t at = Gridded::voxelAt(shape, {x, y, z});
                const glm::dvec3 corner(shape.origin), voxel(static_cast<double>(shape.voxel));
                if (!coverage) {
                    const glm::dvec3 middle = corner + voxel * (glm::dvec3(x, y, z) + 0.5);
                    const bool inside = isInSolid(world, middle);
                    if (!inside) expected_rays += shape.slots;
                    solid += inside;
                    for (size_t s = 0; s < shape.slots; ++s) {
                        const bool truth = !inside && isLit(s, middle);
                        ++compared, lit += truth;
                        wrong += truth != ((voxels[at] >> s & 1) != 0);
                    }
                    continue;
                }
                int counts[4]{}, free = 0;
                for (int sub = 0; sub < 8; ++sub) {
                    const glm::dvec3 place(sub & 1, sub >> 1 & 1, sub >> 2),
                        there = corner + voxel * (glm::dvec3(x, y, z) + 0.25 + 0.5 * place);
                    if (isInSolid(world, there)) continue;
                    ++free;
                    for (size_t s = 0; s < shape.slots; ++s) counts[s] += isLit(s, there);
                }
                solid += free == 0;
                for (size_t s = 0; s < shape.slots; ++s) {
                    const int got = voxels[at * shape.stride + s],
                              truth = free == 0 ? 255 : (254 * counts[s] + free / 2) / free;
                    ++compared, lit += truth == 254;
                    wrong += got != truth;
                    far_off += (got == 255) != (truth == 255) || std::abs(got - truth) > 254 / std::max(free, 1) + 1;
                }
            }
    EXPECT_LE(double(wrong), 1e-3 * double(compared)) << wrong << " of " << compared;
    EXPECT_LE(double(far_off), 1e-4 * double(compared));
    EXPECT_GT(double(lit), 0.1 * double(compared));
    EXPECT_LT(double(lit), 0.9 * double(compared));
    EXPECT_GT(solid, 100u);
    if (!coverage)
        EXPECT_NEAR(double(rays), double(expected_rays), 4.0 * 3); // places on surfaces
    else
        EXPECT_LT(double(rays), 0.9 * 8 * 4 * double(size.x) * size.y * size.z); // some bricks need none
}

TEST_F(GpuTest, ShadowGridHasWhatRaysFind) {
    for (const bool triangles : {false, true}) {
        Scene scene = crowdedScene(triangles);
        scene.render.shadow_grid.voxel = 0.2f;
        scene.render.shadow_grid.values = "bits";
        compareWithRays(device(), scene, false);
        scene.render.shadow_grid.values = "coverage";
        scene.render.shadow_grid.voxel = 0.1f;
        compareWithRays(device(), scene, true);
    }
}

// A grid without objects is lit all over, and coverage needs no ray.
TEST_F(GpuTest, ShadowGridWithoutObjects) {
    Scene scene = emptyScene();
    scene.render.shadow_grid.voxel = 0.25f;
    Gridded gridded(device(), scene, glm::vec3(-2), glm::vec3(2));
    EXPECT_EQ(gridded.recordAll(), 0u);
    for (const float lit : gridded.look(0, {{0, 0, 0}, {1.9f, -1.9f, 0}, {-2, -2, -2}})) EXPECT_EQ(lit, 1.0f);
    EXPECT_EQ(gridded.look(0, {{2.1f, 0, 0}})[0], -1.0f);
}

// RMS distance, in voxels, of a shadow's edge from where it is: an edge of a large thin box under a random sun.
double edgeError(const gpu::Device& device, const std::string& values, const std::string& lookup) {
    Random random(11);
    constexpr float kVoxel = 0.1f, kHeight = 20, kThin = 1e-3f;
    constexpr int kSteps = 120; // along a line of 6 voxels across the edge
    double squares = 0;
    int lines = 0;
    for (int round = 0; round < 24; ++round) {
        Scene scene = emptyScene();
        const glm::vec3 to_light =
            glm::normalize(glm::vec3(random.uniform(-2, 2), random.uniform(0.3f, 1), random.uniform(-2, 2)));
        scene.lights[0].to_light = to_light;
        // The box's face x = 0 in its own axes; the ray from `pivot` meets it.
        const float yaw = random.uniform(-3, 3), c = std::cos(yaw), s = std::sin(yaw);
        const glm::vec3 out(c, 0, -s), pivot = random.inCube(0.3f),
                                       on_edge = pivot + to_light * ((kHeight - pivot.y) / to_light.y);
        scene.boxes = {
            {on_edge - 300.0f * out + glm::vec3(0, 0.5f * kThin, 0), {600, kThin, 2000}, yaw, glm::vec3(0.5f)}};
        scene.render.shadow_grid = {.voxel = kVoxel, .values = values, .lookup = lookup};
        Gridded gridded(device, scene, glm::vec3(-1.2f), glm::vec3(1.2f));
        gridded.recordAll();
        // The edge's shadow is the plane through the pivot along the edge and the sun's rays.
        const glm::vec3 edge(s, 0, c);
        glm::vec3 normal = glm::normalize(glm::cross(edge, to_light));
        if (glm::dot(normal, out) < 0) normal = -normal; // toward the lit side
        std::vector<glm::vec3> places;
        int own = 0;
        while (own < 60) {
            glm::vec3 x = random.inCube(0.9f);
            x -= glm::dot(x - pivot, normal) * normal;
            if (glm::any(glm::greaterThan(glm::abs(x), glm::vec3(0.9f)))) continue;
            ++own;
            for (int i = 0; i < kSteps; ++i)
                places.push_back(x + kVoxel * (6 * (float(i) + 0.5f) / kSteps - 3) * normal);
        }
        const std::vector<float> lit = gridded.look(0, places);
        for (int line = 0; line < own; ++line) {
            double sum = 0;
            for (int i = 0; i < kSteps; ++i) sum += double(lit[size_t(line) * kSteps + size_t(i)]) - (i >= kSteps / 2);
            squares += std::pow(sum * 6 / kSteps, 2);
            ++lines;
        }
    }
    return std::sqrt(squares / lines);
}

TEST_F(GpuTest, ShadowGridPutsEdgesWhereTheyAre) {
    const double nearest = edgeError(device(), "bits", "nearest"), linear = edgeError(device(), "bits", "linear"),
                 coverage = edgeError(device(), "coverage", "linear");
    RecordProperty("edges", fmt::format("{:.4f} {:.4f} {:.4f}", nearest, linear, coverage));
    // 1 / sqrt(12), and what the same sums give for planes in all directions without a renderer.
    EXPECT_NEAR(nearest, 0.288, 0.05 * 0.288);
    EXPECT_NEAR(linear, 0.186, 0.05 * 0.186);
    EXPECT_NEAR(coverage, 0.054, 0.1 * 0.054);
    EXPECT_LE(coverage, 0.06);
}

gpu::Eye eyeOf(const Pose& pose) { return eyeBlock({pose, 64, 36}, RenderSettings{}); }

Pose randomPose(Random& random) { return lookAt(random.inCube(5), random.inCube(3), random.uniform(0.3f, 1.2f)); }

// Places in the eye's field of view, its rim included, and in the box.
void addSeen(Random& random, const gpu::Eye& eye, uint32_t count, float half, std::vector<glm::vec3>& places) {
    for (uint32_t i = 0, tries = 0; i < count && tries < 400 * count; ++tries) {
        const auto coordinate = [&](float size) {
            return std::clamp(random.uniform(-0.2f, 1.2f), 0.0f, 1.0f) * size; // a third of them on the rim
        };
        const glm::vec3 direction =
            eye.ray + coordinate(float(eye.size.x)) * eye.ray_right + coordinate(float(eye.size.y)) * eye.ray_down;
        const glm::vec3 x = eye.position + random.uniform(eye.near_depth, 14) * direction;
        if (glm::any(glm::greaterThan(glm::abs(x), glm::vec3(half)))) continue;
        places.push_back(x);
        ++i;
    }
}

// Voxels are poisoned in bits of slots that no light has. Whatever is made has zeros there.
TEST_F(GpuTest, ShadowGridIsReadOnlyWhereItIsMade) {
    Random random(3);
    for (const char* const values : {"bits", "coverage"})
        for (const char* const lookup : {"nearest", "linear"}) {
            Scene scene = crowdedScene(false);
            scene.lights.resize(1);
            scene.render.shadow_grid = {.voxel = 0.15f, .values = values, .lookup = lookup, .parity = true};
            const uint32_t slot = scene.render.shadow_grid.values == "bits" ? 7 : 3;
            Gridded gridded(device(), scene, glm::vec3(-4), glm::vec3(4));
            gridded.recordAll();
            std::vector<glm::vec3> everywhere(2000);
            for (glm::vec3& x : everywhere) x = random.inCube(3.99f);
            double beyond = 0;
            for (int round = 0; round < 12; ++round) {
                if (round % 4 == 0) {
                    // Another shape clears all.
                    gridded.scene().render.shadow_grid.voxel *= 1.01f;
                    gridded.record({});
                    gridded.poison(0x80808080);
                } else if (round % 4 == 2) {
                    gridded.changeObjects();
                }
                std::vector<gpu::Eye> eyes;
                for (int i = 0; i <= round % 3; ++i) eyes.push_back(eyeOf(randomPose(random)));
                gridded.record(eyes);
                std::vector<glm::vec3> places;
                for (const gpu::Eye& eye : eyes) addSeen(random, eye, 1500, 3.99f, places);
                if (places.empty()) continue;
                for (const float lit : gridded.look(slot, places)) ASSERT_EQ(lit, 0.0f) << values << ' ' << round;
                for (const float lit : gridded.look(slot, everywhere)) beyond += lit > 0;
            }
            EXPECT_GT(beyond, 200) << values; // what no eye sees is not made
        }
}

TEST_F(GpuTest, ShadowGridAtRestTracesNothing) {
    Random random(8);
    for (const char* const values : {"bits", "coverage"}) {
        Scene scene = crowdedScene(true);
        scene.render.shadow_grid = {.voxel = 0.2f, .values = values};
        Gridded gridded(device(), scene, glm::vec3(-4), glm::vec3(4));
        const std::vector<gpu::Eye> one{eyeOf(lookAt({0, 0, 8}, {0.5f, 0, 0}, 0.6f))},
            two{one[0], eyeOf(lookAt({-7, 1, 0}, {0, 0, 2}, 0.6f))};
        const uint64_t first = gridded.record(one);
        EXPECT_GT(first, 0u);
        EXPECT_EQ(gridded.record(one), 0u);
        const uint64_t more = gridded.record(two); // what the second eye sees besides
        EXPECT_GT(more, 0u);
        EXPECT_EQ(gridded.record(two), 0u);
        EXPECT_EQ(gridded.record(one), 0u);
        const std::vector<uint8_t> at_rest = gridded.voxels();
        gridded.changeObjects();
        EXPECT_EQ(gridded.record(two), first + more);
        EXPECT_EQ(gridded.voxels(), at_rest);
        gridded.scene().lights[1].position.x += 0.1f;
        EXPECT_GT(gridded.record(two), 0u);
        EXPECT_EQ(gridded.record(two), 0u);
        gridded.scene().render.shadow_grid.retrace = true;
        const uint64_t again = gridded.record(two);
        EXPECT_GT(again, 0u);
        EXPECT_EQ(gridded.record(two), again);
        EXPECT_LT(gridded.record({}), 1u);
    }
}

TEST_F(GpuTest, ShadowGridByHalves) {
    for (const char* const values : {"bits", "coverage"}) {
        Scene scene = crowdedScene(false);
        scene.render.shadow_grid = {.voxel = 0.2f, .values = values, .parity = true};
        Gridded whole(device(), scene, glm::vec3(-4), glm::vec3(4)),
            halves(device(), scene, glm::vec3(-4), glm::vec3(4));
        whole.scene().render.shadow_grid.parity = false;
        const uint64_t all = whole.recordAll();
        EXPECT_EQ(halves.recordAll(), all); // what was never made
        EXPECT_EQ(halves.voxels(), whole.voxels());
        for (Gridded* gridded : {&whole, &halves})
            gridded->scene().lights[0].to_light = glm::normalize(glm::vec3(-0.5f, 0.7f, 0.1f));
        const uint64_t full = whole.recordAll(), one = halves.recordAll();
        EXPECT_NEAR(double(one), 0.5 * double(full), 0.05 * double(full));
        EXPECT_NE(halves.voxels(), whole.voxels());
        EXPECT_EQ(halves.recordAll(), full - one);
        EXPECT_EQ(halves.voxels(), whole.voxels());
        EXPECT_EQ(halves.recordAll(), 0u);
        // A light that moves on and on: no layer is older than the call before.
        for (const float z : {0.2f, 0.4f, 0.6f}) {
            for (Gridded* gridded : {&whole, &halves})
                gridded->scene().lights[0].to_light = glm::normalize(glm::vec3(-0.5f, 0.7f, z));
            whole.recordAll();
            halves.recordAll();
        }
        halves.recordAll();
        EXPECT_EQ(halves.voxels(), whole.voxels());
    }
}

TEST_F(GpuTest, ShadowGridFitsItsMemory) {
    const ShadowGridSettings settings{.voxel = 0.01f};
    const gpu::ShadowGridBlock shape = shadowGridShape(settings, glm::vec3(-5), glm::vec3(5), 8);
    EXPECT_LE(double(shape.bricks.x) * shape.bricks.y * shape.bricks.z * 512 * shape.stride,
              double(gpu::kLargestBinding));
    EXPECT_GT(shape.voxel, 0.01f);
    EXPECT_EQ(shape.stride, 8u);
    const glm::vec3 end = shape.origin + shape.voxel * glm::vec3(shape.bricks * 8u);
    EXPECT_TRUE(glm::all(glm::lessThanEqual(shape.origin, glm::vec3(-5))));
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(end, glm::vec3(5))));
}

TEST_F(GpuTest, ShadowSlotsStay) {
    std::vector<gpu::LocalLight> lights(10);
    for (uint32_t i = 0; i < lights.size(); ++i) lights[i].shadows = 1, lights[i].intensity = glm::vec3(1 + float(i));
    lights[9].shadows = 0;
    gpu::Tick tick{};
    const ShadowSlots first = shadowSlots(tick, lights, {});
    EXPECT_EQ(first.lights, (std::vector<uint32_t>{8, 7, 6, 5, 4, 3, 2, 1}));
    lights[0].intensity = glm::vec3(20);
    lights[5].intensity = glm::vec3(30);
    const ShadowSlots second = shadowSlots(tick, lights, first); // the new one takes the place of the weakest
    EXPECT_EQ(second.lights, (std::vector<uint32_t>{8, 7, 6, 5, 4, 3, 2, 0}));
    tick.sun.irradiance = glm::vec3(1);
    EXPECT_EQ(shadowSlots(tick, lights, second).lights[0], ShadowSlots::kSun);
    EXPECT_EQ(shadowSlots(tick, lights, second).lights.size(), 8u);
}

} // namespace
} // namespace brume::test::shadow_grid_test
