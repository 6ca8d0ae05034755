// Media of ellipsoids on the device: pictures against the reference, and ellipsoids that are balls against balls.
#include <cmath>
#include <fstream>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::ellipsoids_test {
namespace {

struct Ellipsoids {
    std::vector<Point> points;
    std::vector<gpu::EllipsoidAxes> axes;
};

// Semi-axes of these lengths, turned by chance.
gpu::EllipsoidAxes turned(glm::vec3 lengths, Random& random) {
    const glm::vec3 a = glm::normalize(random.inCube(1) + 0.1f), b = glm::normalize(glm::cross(a, random.inCube(1)));
    return {lengths.x * a, lengths.y * b, lengths.z * glm::cross(a, b)};
}

// Points by chance, the longest axis of each `scale`, the others between it and `least` of it.
Ellipsoids cloud(uint32_t count, float extent, float scale, float sigma_t, float least, uint32_t seed = 1) {
    Ellipsoids out{randomPoints(count, extent, scale, sigma_t, seed), {}};
    Random random(seed + 1);
    for (uint32_t i = 0; i < count; ++i)
        out.axes.push_back(turned({1, random.uniform(least, 1), random.uniform(least, 1)}, random));
    return out;
}

Scene sceneOf(const Ellipsoids& medium, float falloff = 1.6f) {
    Scene scene = test::sceneOf(medium.points, falloff);
    std::ofstream ply(scene.medium.file, std::ios::binary);
    ply << "ply\nformat binary_little_endian 1.0\nelement vertex " << medium.points.size() << '\n';
    for (const char* name : {"x", "y", "z", "scale", "sigma_t", "red", "green", "blue", "axis_a_x", "axis_a_y",
                             "axis_a_z", "axis_b_x", "axis_b_y", "axis_b_z", "axis_c_x", "axis_c_y", "axis_c_z"})
        ply << "property float " << name << '\n';
    ply << "end_header\n";
    for (size_t i = 0; i < medium.points.size(); ++i) {
        ply.write(reinterpret_cast<const char*>(&medium.points[i]), sizeof(Point));
        ply.write(reinterpret_cast<const char*>(&medium.axes[i]), sizeof(gpu::EllipsoidAxes));
    }
    scene.medium.model = kEllipsoidMedium;
    scene.render.method = "slabs";
    return scene;
}

const Pose kOutside = lookAt({3, 4, 12}, {0, 0, 0}, 0.7f), kInside = lookAt({0.5f, 0.2f, 1}, {-2, 0, -1}, 1.2f);

class EllipsoidsTest : public JudgedTest {
protected:
    // Relative RMSE over all pixels: of opacity, and of the red light that the medium scatters.
    struct Errors {
        double opacity, light;
    };
    static Errors errorsBeside(const reference::World& world, const Scene& scene, const Pose& pose) {
        const Picture picture = render(device(), scene, pose, kWidth, kHeight);
        const reference::Picture truth =
            truePicture(world, reference::perspective(pose, int(kWidth), int(kHeight), kNear), 1e-5);
        double errors = 0, values = 0, lights = 0, lit = 0;
        for (size_t i = 0; i < truth.radiance.size(); ++i) {
            const double opacity = 1 - truth.transmittance[i], light = truth.radiance[i].x;
            errors += std::pow(1 - double(picture.pixels[i].a) - opacity, 2), values += opacity * opacity;
            lights += std::pow(double(picture.pixels[i].x) - light, 2), lit += light * light;
        }
        EXPECT_GT(values, 10) << "something is seen";
        return {std::sqrt(errors / values), std::sqrt(lights / lit)};
    }
};

// In ambient light alone nothing is shadowed: the picture is the medium's transmittance.
Scene inAmbientLight(Scene scene) {
    scene.lights[0].irradiance = glm::vec3(0);
    scene.sky.ambient = glm::vec3(1);
    return scene;
}

TEST_F(EllipsoidsTest, RaysOfEveryPixelAreTheReferences) {
    for (const float least : {0.5f, 0.1f, 0.02f}) {
        Scene scene = inAmbientLight(sceneOf(cloud(60, 6, 3, 1, least)));
        scene.render.rate = 1;
        scene.render.slabs = 384;
        for (const Pose& pose : {kOutside, kInside}) {
            const Error error = errorOf(scene, pose);
            std::printf("least %.2f: %.4f %%, worst pixel %.3f %%\n", double(least), 100 * error.rmse,
                        100 * error.worst);
            EXPECT_LE(error.rmse, 1e-3) << least;
        }
    }
}

TEST_F(EllipsoidsTest, CoarseRaysAndNodesAreNearIt) {
    Scene scene = inAmbientLight(sceneOf(cloud(60, 6, 3, 1, 0.4f)));
    scene.render.grid.spacing = 0.25f;
    judge(scene, {kOutside, kInside});
}

TEST_F(EllipsoidsTest, LitPicturesAreTheReferences) {
    Scene scene = sceneOf(cloud(60, 6, 3, 1, 0.4f));
    scene.render.shadow_slices = 64;
    scene.render.grid.spacing = 0.25f;
    judge(scene, {kOutside, kInside});
}

TEST_F(EllipsoidsTest, PointsAndFogShineThroughThem) {
    Scene scene = sceneOf(cloud(30, 6, 3, 1, 0.4f));
    scene.lights[0].irradiance = glm::vec3(0);
    scene.lights.push_back({.type = kPoint, .position = {1, 4, 5}, .intensity = glm::vec3(60), .radius = 0.1f});
    scene.fogs.push_back({.extinction = 0.02f});
    scene.render.grid.spacing = 0.25f;
    judge(scene, {kOutside}, 1e-2);
}

// Tiles add particles one by one, near to far: that of the reference which does so, too.
TEST_F(EllipsoidsTest, TilesAreTheSequentialReference) {
    for (const char* quadrature : {"cached", "hermite"}) {
        Scene scene = sceneOf(cloud(60, 6, 3, 0.1f, 0.1f));
        scene.render.method = "tiles";
        scene.render.tiles.quadrature = quadrature;
        scene.render.shadow_slices = 64;
        reference::World world = worldOf(scene);
        world.composition = reference::Composition::sequential;
        for (const Pose& pose : {kOutside, kInside}) {
            const Errors errors = errorsBeside(world, scene, pose);
            std::printf("%s: opacity %.5f %%, light %.3f %%\n", quadrature, 100 * errors.opacity, 100 * errors.light);
            EXPECT_LT(errors.opacity, 1e-4);
            EXPECT_LT(errors.light, 2e-2);
        }
    }
}

// What other methods read are the nodes, which hold ellipsoids as they do balls: they err no more than for these.
TEST_F(EllipsoidsTest, MethodsThatReadNodesErrAsForBalls) {
    Scene scene = sceneOf(cloud(60, 6, 3, 1, 0.4f));
    Ellipsoids of_balls = cloud(60, 6, 2, 1, 0.4f);
    Scene balls = test::sceneOf(of_balls.points, 1.6f);
    for (const char* method : {"froxels", "lit", "march", "gradients"}) {
        scene.render.method = balls.render.method = method;
        scene.render.shadow_slices = balls.render.shadow_slices = 64;
        const Error error = errorOf(scene, kOutside), of_ball = errorOf(balls, kOutside);
        std::printf("%s: %.2f %%, of balls %.2f %%\n", method, 100 * error.rmse, 100 * of_ball.rmse);
        EXPECT_LT(error.rmse, 2 * of_ball.rmse + 0.01) << method;
    }
}

// The proxy is the tetrahedron, stretched along the axes as the Gaussian is.
TEST_F(EllipsoidsTest, IntervalsAreThoseOfStretchedTetrahedra) {
    Scene scene = sceneOf(cloud(1, 0, 3, 2, 0.3f));
    scene.render.method = "isv";
    scene.render.isv = {.quadrature = "transmittance", .steps = 3};
    reference::World world = worldOf(scene);
    world.support = reference::Support::tetrahedron;
    for (const Pose& pose : {kOutside, lookAt({0.1f, 0, 1.2f}, {0, 0, 0}, 1.2f)})
        EXPECT_LT(errorsBeside(world, scene, pose).opacity, 1e-4);
}

// Ellipsoids of equal axes are balls: their pictures differ from the balls' own by rounding alone. Proxies are turned
// with the axes, so those of isv are the world's.
TEST_F(EllipsoidsTest, OfEqualAxesAreBalls) {
    Ellipsoids medium = cloud(40, 6, 3, 1, 1);
    const Scene turned = sceneOf(medium);
    for (gpu::EllipsoidAxes& axes : medium.axes) axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Scene straight = sceneOf(medium);
    for (const char* method : {"slabs", "grid", "tiles", "isv"}) {
        Scene scene = std::string(method) == "isv" ? straight : turned;
        scene.render.method = method;
        const Picture ellipsoids = render(device(), scene, kOutside, kWidth, kHeight);
        scene.medium.model = kSumMedium;
        const Picture balls = render(device(), scene, kOutside, kWidth, kHeight);
        float worst = 0, most = 0;
        for (size_t i = 0; i < balls.pixels.size(); ++i) {
            const glm::vec4 off = glm::abs(balls.pixels[i] - ellipsoids.pixels[i]);
            worst = std::max({worst, off.x, off.y, off.z, off.a}), most = std::max(most, balls.pixels[i].x);
        }
        EXPECT_GT(most, 0.01f) << method;
        EXPECT_LT(worst, 2e-4f) << method;
    }
}

TEST_F(EllipsoidsTest, OtherMethodsRefuseThem) {
    Scene scene = sceneOf(cloud(3, 6, 3, 1, 0.4f));
    for (const char* method : {"sphere", "sprites", "tetrahedra"}) {
        scene.render.method = method;
        try {
            render(device(), scene, kOutside, kWidth, kHeight);
            FAIL() << method;
        } catch (const gpu::Error& error) {
            EXPECT_NE(
                std::string(error.what()).find("it draws no medium.model = \"ellipsoids\"; use slabs, grid or tiles"),
                std::string::npos)
                << error.what();
        }
    }
}

} // namespace
} // namespace brume::test::ellipsoids_test
