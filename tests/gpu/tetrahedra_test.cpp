// Media of tetrahedra on the device: depths against intervals found in double, one tetrahedron after the other, and
// pictures against the reference.
#include "common/tetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "server/plan/memory.h"
#include "tests/gpu/judged.h"
#include "tests/gpu/light_passes.h"

namespace brume::test {
namespace {

struct Mesh {
    std::vector<Point> points;
    std::vector<glm::uvec4> cells;
};

// `side`^3 cubes around the origin, `width` m together, each cut into six tetrahedra about a diagonal. Points move by
// up to `jitter` of a cube's width. Precondition: jitter < 0.2, which turns none inside out.
Mesh lattice(uint32_t side, float width, float jitter, const std::function<float(glm::vec3)>& extinction,
             uint32_t seed = 1) {
    Mesh mesh;
    Random random(seed);
    const float cube = width / float(side);
    for (uint32_t z = 0; z <= side; ++z)
        for (uint32_t y = 0; y <= side; ++y)
            for (uint32_t x = 0; x <= side; ++x) {
                const glm::vec3 at = cube * (glm::vec3(x, y, z) + random.inCube(jitter)) - 0.5f * width;
                mesh.points.push_back({.centre = at, .scale = cube, .sigma_t = extinction(at)});
            }
    constexpr std::array<std::array<int, 3>, 6> kOrders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    const auto number = [&](glm::uvec3 at) { return (at.z * (side + 1) + at.y) * (side + 1) + at.x; };
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                for (const std::array<int, 3>& order : kOrders) {
                    glm::uvec3 at(x, y, z);
                    glm::uvec4 cell(number(at));
                    for (int i = 0; i < 3; ++i) {
                        ++at[order[size_t(i)]];
                        cell[i + 1] = number(at);
                    }
                    mesh.cells.push_back(cell);
                }
    return mesh;
}

// A body-centred cubic lattice: `side`^3 cubes with their middles. A tetrahedron is between the middles of two cubes
// and an edge of the face that they share.
Mesh centred(uint32_t side, float width, const std::function<float(glm::vec3)>& extinction) {
    Mesh mesh;
    const float cube = width / float(side);
    const auto add = [&](uint32_t count, float first) {
        for (uint32_t z = 0; z < count; ++z)
            for (uint32_t y = 0; y < count; ++y)
                for (uint32_t x = 0; x < count; ++x) {
                    const glm::vec3 at = cube * (glm::vec3(x, y, z) + first) - 0.5f * width;
                    mesh.points.push_back({.centre = at, .scale = cube, .sigma_t = extinction(at)});
                }
    };
    add(side + 1, 0);
    add(side, 0.5f);
    const auto corner = [&](glm::uvec3 at) { return (at.z * (side + 1) + at.y) * (side + 1) + at.x; };
    const auto middle = [&](glm::uvec3 at) {
        return (side + 1) * (side + 1) * (side + 1) + (at.z * side + at.y) * side + at.x;
    };
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    const glm::uvec3 here(x, y, z);
                    glm::uvec3 next = here, across(0), along(0);
                    if (++next[axis] == side) continue;
                    across[(axis + 1) % 3] = 1, along[(axis + 2) % 3] = 1;
                    const glm::uvec3 around[]{next, next + across, next + across + along, next + along};
                    for (int i = 0; i < 4; ++i)
                        mesh.cells.emplace_back(middle(here), middle(next), corner(around[i]),
                                                corner(around[(i + 1) % 4]));
                }
    return mesh;
}

float soft(glm::vec3 at) { return std::max(1.2f - glm::length(at) / 2.5f, 0.0f); }
float even(glm::vec3) { return 0.4f; }
float inner(glm::vec3 at) { return std::max(1 - glm::length(at) / 1.5f, 0.0f); } // none outside of lattices 4 m wide

Scene sceneOf(const Mesh& mesh) {
    Scene scene = test::sceneOf(mesh.points, 1, mesh.cells);
    scene.render.shadow_size = scene.render.shadow_slices = 0; // as the medium needs
    return scene;
}

// The part of a ray within one tetrahedron, by its four planes.
struct Part {
    double begin = -1e300, end = 1e300;
    double sigma[2]{}; // at both
};
Part partOf(const Mesh& mesh, glm::uvec4 cell, glm::dvec3 origin, glm::dvec3 dir) {
    glm::dvec3 corner[4];
    for (int m = 0; m < 4; ++m) corner[m] = glm::dvec3(mesh.points[cell[m]].centre) - origin;
    Part part;
    double at_origin = 0, slope = 0; // of the extinction along the ray
    for (int m = 0; m < 4; ++m) {
        const glm::dvec3 a = corner[(m + 1) % 4], b = corner[(m + 2) % 4], c = corner[(m + 3) % 4];
        glm::dvec3 normal = glm::cross(b - a, c - a);
        normal /= glm::dot(normal, corner[m] - a); // the corner's own coordinate is dot(normal, x - a)
        const double here = -glm::dot(normal, a), along = glm::dot(normal, dir);
        const double sigma = double(mesh.points[cell[m]].sigma_t);
        at_origin += sigma * here, slope += sigma * along;
        if (along > 0) part.begin = std::max(part.begin, -here / along);
        if (along < 0) part.end = std::min(part.end, -here / along);
        if (along == 0 && here < 0) part.end = part.begin;
    }
    for (const int end : {0, 1}) part.sigma[end] = at_origin + slope * (end == 0 ? part.begin : part.end);
    return part;
}

double depthOn(const Mesh& mesh, glm::dvec3 origin, glm::dvec3 dir, double begin, double end) {
    double depth = 0;
    for (const glm::uvec4 cell : mesh.cells) {
        const Part part = partOf(mesh, cell, origin, dir);
        const double from = std::max(part.begin, begin), to = std::min(part.end, end);
        if (!(to > from)) continue;
        const auto sigma = [&](double t) {
            return glm::mix(part.sigma[0], part.sigma[1], (t - part.begin) / (part.end - part.begin));
        };
        depth += 0.5 * (sigma(from) + sigma(to)) * (to - from);
    }
    return depth;
}

class TetrahedraTest : public JudgedTest {
protected:
    // Rays in double are moved aside by less than a float can tell: they may lie in planes of faces, which both sides
    // have.
    static constexpr glm::dvec3 kAside{1.1e-7, 0.7e-7, 1.3e-7};

    // Optical depth on a pixel's ray.
    static double depthOnPixel(const Mesh& mesh, const Pose& pose, uint32_t x, uint32_t y) {
        const glm::dvec3 dir = pixelDirection(pose, kColumns, kRows, x, y);
        const double metres = glm::length(dir);
        return depthOn(mesh, glm::dvec3(pose.position) + kAside, dir / metres, kNear * metres, 1e9);
    }
    // The largest difference of transmittance to the mesh's own, over a picture's pixels.
    static double worstTransmittance(const Mesh& mesh, const Pose& pose) {
        const Picture picture = render(device(), sceneOf(mesh), pose, kColumns, kRows);
        double worst = 0;
        for (uint32_t y = 0; y < kRows; ++y)
            for (uint32_t x = 0; x < kColumns; ++x) {
                EXPECT_TRUE(std::isfinite(picture.at(x, y).r)) << x << ' ' << y;
                const double truth = std::exp(-depthOnPixel(mesh, pose, x, y));
                worst = std::max(worst, std::abs(double(picture.at(x, y).a) - truth));
            }
        return worst;
    }
    // The largest difference of light depths at planes to the mesh's own.
    static double worstShadow(const Scene& scene, const Mesh& mesh) {
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const gpu::Tick tick = makeTick(scene, simulation.now(), particles, {});
        TetrahedraBuffers buffers(device(), scene.tetrahedra);
        buffers.follow(particles);
        ShadowVolume volume(device(), uint32_t(particles.size()));
        recordAndWait(device(), tick, particles,
                      [&](gpu::Commands& commands, const gpu::Resource& block, const gpu::Buffer& buffer) {
                          volume.record(commands, block, tick, buffer, false, &buffers);
                      });
        const std::vector<float> texels = readImage(device(), volume.image(), 4);
        const glm::dvec3 toward(tick.sun.to_light);
        double worst = 0;
        for (uint32_t y = 0; y < tick.map.texels.y; y += 1 + tick.map.texels.y / 20)
            for (uint32_t x = 0; x < tick.map.texels.x; x += 1 + tick.map.texels.x / 20)
                for (uint32_t plane = 0; plane < tick.map.slices; ++plane) {
                    const glm::dvec3 part((x + 0.5) / tick.map.texels.x, (y + 0.5) / tick.map.texels.y,
                                          1 - double(plane) / (tick.map.slices - 1));
                    const glm::dvec3 at = glm::mix(glm::dvec3(tick.map.lo), glm::dvec3(tick.map.hi), part);
                    const uint32_t layer = std::min(plane / 3, volume.image().layers() - 1);
                    const size_t texel = (size_t(layer) * tick.map.texels.y + y) * tick.map.texels.x + x;
                    const double got = double(texels[4 * texel + plane - 3 * layer]);
                    const double truth = depthOn(mesh, fromLightSpace(tick, at) + kAside, toward, 0, 1e9);
                    worst = std::max(worst, std::abs(got - truth));
                }
        return worst;
    }
    static constexpr uint32_t kColumns = 49, kRows = 33;
};

TEST_F(TetrahedraTest, TransmittanceIsThatOfAllIntervals) {
    const Pose outside = lookAt({3, 4, 9}, {0, 0, 0}, 0.7f);
    EXPECT_LT(worstTransmittance(lattice(1, 4, 0, even), outside), 1e-5);
    EXPECT_LT(worstTransmittance(lattice(5, 4, 0.15f, soft), outside), 1e-5);
    EXPECT_LT(worstTransmittance(lattice(5, 4, 0.15f, soft), lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.5f)), 1e-5)
        << "from within";
    Mesh stretched = lattice(5, 4, 0.15f, soft);
    for (Point& point : stretched.points) point.centre *= glm::vec3(8, 1, 0.2f);
    EXPECT_LT(worstTransmittance(stretched, lookAt({9, 2, 6}, {0, 0, 0}, 0.9f)), 1e-5) << "slivers";
}

// The middle column and row of pixels, and its diagonals, lie in planes of faces; the middle one goes through corners.
// A line in the plane of an outside face is in the mesh or beside it: there is no medium there.
TEST_F(TetrahedraTest, RaysThroughCornersAndEdgesLoseNothing) {
    for (const Mesh& mesh : {lattice(4, 4, 0, inner), centred(4, 4, inner), centred(5, 4, inner)}) {
        for (const glm::vec3 from : {glm::vec3(0, 0, 9), glm::vec3(9, 0, 0), glm::vec3(0, 8, 0.001f),
                                     glm::vec3(5, 5, 5), glm::vec3(5, 0, 5), glm::vec3(0, 0, 1), glm::vec3(0.5f)})
            EXPECT_LT(worstTransmittance(mesh, lookAt(from, {0, 0, 0}, 0.8f)), 2e-4)
                << mesh.cells.size() << " from " << from.x << ' ' << from.y << ' ' << from.z;
        for (const float aside : {0.5f, 1.0f}) // along lines through middles of cubes, and along edges
            EXPECT_LT(worstTransmittance(mesh, lookAt({aside, aside, 9}, {aside, aside, 0}, 0.8f)), 2e-4) << aside;
    }
}

TEST_F(TetrahedraTest, HolesAndSeparatePiecesAreMetInOrder) {
    Mesh mesh = lattice(6, 4, 0.1f, even);
    Random random(3);
    std::erase_if(mesh.cells, [&](glm::uvec4) { return random.uniform(0, 1) < 0.4f; });
    EXPECT_LT(worstTransmittance(mesh, lookAt({3, 4, 9}, {0, 0, 0}, 0.7f)), 1e-4);
    EXPECT_LT(worstTransmittance(mesh, lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.5f)), 1e-4) << "from within";
}

TEST_F(TetrahedraTest, PiecesThatTouchAreAsOne) {
    const Mesh one = lattice(4, 4, 0.15f, soft);
    Mesh apart; // every tetrahedron has corners of its own
    for (const glm::uvec4 cell : one.cells) {
        apart.cells.emplace_back(uint32_t(apart.points.size()) + glm::uvec4(0, 1, 2, 3));
        for (int m = 0; m < 4; ++m) apart.points.push_back(one.points[cell[m]]);
    }
    EXPECT_LT(worstTransmittance(apart, lookAt({3, 4, 9}, {0, 0, 0}, 0.7f)), 1e-4);
}

TEST_F(TetrahedraTest, OpticalDepthsFromAThousandthToAThousandHold) {
    const Pose pose = lookAt({1, 2, 6}, {0, 0, 0}, 0.7f);
    for (const float depth : {1e-3f, 1e-1f, 10.0f, 1e3f}) {
        const Mesh mesh = lattice(3, 4, 0.15f, [&](glm::vec3) { return depth / 4; });
        EXPECT_LT(worstTransmittance(mesh, pose), 3e-5) << depth; // places are rounded by some 1e-7 m: 250/m
        Scene scene = sceneOf(mesh);
        scene.sky.ambient = glm::vec3(1); // a medium of albedo 1 in even light of radiance 1 has that, too
        scene.lights[0].irradiance = glm::vec3(0);
        const Picture picture = render(device(), scene, pose, kColumns, kRows);
        for (const glm::vec4& pixel : picture.pixels) EXPECT_NEAR(double(pixel.r + pixel.a), 1, 2e-5) << depth;
        const double opacity = -std::expm1(-depthOnPixel(mesh, pose, kColumns / 2, kRows / 2));
        const double drawn = double(picture.at(kColumns / 2, kRows / 2).r);
        EXPECT_NEAR(drawn / opacity, 1, 1e-4) << depth; // relative: a thin medium loses nothing
    }
}

TEST_F(TetrahedraTest, ShadowsOfTheSunAreExactAtPlanes) {
    const struct {
        Mesh mesh;
        glm::vec3 to_light;
        uint32_t texels; // of the last one columns lie on lines of the lattice
    } cases[]{{lattice(5, 4, 0.15f, soft), glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f)), 256},
              {centred(4, 4, soft), {0, 1, 0}, 36}};
    for (const auto& [mesh, to_light, texels] : cases) {
        Scene scene = sceneOf(mesh);
        scene.lights[0].to_light = to_light;
        scene.render.shadow_size = texels;
        scene.render.shadow_slices = 16;
        EXPECT_LT(worstShadow(scene, mesh), 2e-5) << texels;
    }
}

TEST_F(TetrahedraTest, MemoryIsWhatIsPredicted) {
    const Scene scene = sceneOf(centred(6, 4, soft));
    const uint64_t before = device().memoryInUse();
    const TetrahedraBuffers buffers(device(), scene.tetrahedra);
    const uint64_t took = device().memoryInUse() - before, predicted = tetrahedraMemory(&*scene.tetrahedra).device;
    EXPECT_EQ(buffers.cells.size() + buffers.faces.size() + buffers.nodes.size(), predicted);
    EXPECT_LT(took - predicted, 64u << 10) << "alignment";
}

TEST_F(TetrahedraTest, PicturesAreThoseOfTheReference) {
    Mesh mesh = lattice(6, 4, 0.15f, soft);
    Scene scene = sceneOf(mesh);
    const Pose outside = lookAt({3, 4, 7}, {0, 0, 0}, 0.8f), within = lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.2f);
    const auto judged = [&](const char* name, const Pose& pose) {
        const Error error = errorOf(scene, pose);
        std::printf("%-10s %.4f %%, worst pixel %.3f %%\n", name, 100 * error.rmse, 100 * error.worst);
        EXPECT_LT(error.rmse, kAllowed) << name;
    };
    judged("outside", outside);
    judged("within", within);
    for (Point& point : mesh.points) point.albedo = 0.5f + 0.1f * point.centre, point.sigma_t *= 3;
    scene = sceneOf(mesh);
    scene.medium.anisotropy = 1;
    scene.medium.asymmetry = 0.6f;
    scene.sky.ambient = glm::vec3(0.05f);
    judged("coloured", outside);
    scene.medium.extinction_colour = {1, 0.6f, 0.3f};
    judged("hues", outside);
}

TEST_F(TetrahedraTest, ObjectsEndRaysAndShadowTheMedium) {
    Scene scene = sceneOf(lattice(6, 4, 0.15f, soft));
    scene.planes = {{.height = -2}};
    scene.boxes = {{.centre = {0.5f, 1.2f, 0}, .size = {1, 0.3f, 1}, .yaw = 0.4f}};
    scene.render.tetrahedra.nodes = 3;
    const Error error = errorOf(scene, lookAt({3, 4, 7}, {0, 0, 0}, 0.8f));
    std::printf("objects    %.4f %%, worst pixel %.3f %%\n", 100 * error.rmse, 100 * error.worst);
    EXPECT_LT(error.rmse, 2e-2); // the edge of a shadow lies anywhere within a tetrahedron
}

// A mesh as fine as its particles' detail is drawn as slabs draw the particles, with light that scatters again, too.
TEST_F(TetrahedraTest, ScatteringIsThatOfSlabs) {
    const Point blob{.scale = 10, .sigma_t = 1.2f, .albedo = glm::vec3(0.9f, 0.95f, 1)};
    const auto gaussian = [&](glm::vec3 at) { return blob.sigma_t * std::exp(-50 * glm::dot(at, at) / 100); };
    Mesh mesh = centred(20, 8, gaussian);
    for (Point& point : mesh.points) point.albedo = blob.albedo;
    Scene of_mesh = sceneOf(mesh), of_blob = test::sceneOf({blob});
    of_blob.render.method = "slabs";
    of_blob.render.rate = 1;
    const Pose pose = lookAt({3, 4, 9}, {0, 0, 0}, 0.8f);
    for (const char* scattering : {"single", "octaves", "propagation"})
        for (const bool box : {false, true}) {
            // Slabs shadow the octaves of a ray all alike, by the part of its sunlight that objects let through.
            if (box && std::string(scattering) == "octaves") continue;
            for (Scene* scene : {&of_mesh, &of_blob}) {
                scene->render.scattering = scattering;
                scene->render.shadow_size = 64, scene->render.shadow_slices = 64;
                scene->medium.anisotropy = 1, scene->medium.asymmetry = 0.5f;
                scene->boxes.clear();
                if (box) scene->boxes = {{.centre = {0.6f, 2.5f, 1}, .size = {3, 0.2f, 3}, .albedo = glm::vec3(0)}};
            }
            const Picture a = render(device(), of_mesh, pose, kColumns, kRows),
                          b = render(device(), of_blob, pose, kColumns, kRows);
            double errors = 0, values = 0;
            for (size_t i = 0; i < a.pixels.size(); ++i) {
                const glm::dvec3 off(a.pixels[i] - b.pixels[i]), value(b.pixels[i]);
                errors += glm::dot(off, off), values += glm::dot(value, value);
            }
            std::printf("%-12s%s %.2f %%\n", scattering, box ? " box" : "    ", 100 * std::sqrt(errors / values));
            EXPECT_LT(std::sqrt(errors / values), 0.03) << scattering << box;
        }
}

} // namespace
} // namespace brume::test
