// Methods froxels, lit and gradients: what one viewer sees does not depend on who else looks, by every kind of shadow.
#include <gtest/gtest.h>

#include "tests/gpu/fixture.h"
#include "tests/layer.h"

namespace brume::test::among_others_test {
namespace {

// A renderer that is asked tick after tick for the first viewer's picture, and for those of others who look on.
class Watched {
public:
    Watched(const gpu::Device& device, const Scene& scene, uint32_t others)
        : renderer_(device, scene, 1), submission_(device, "test"), others_(others) {}

    std::vector<uint8_t> see(const Scene& scene, const Pose& pose) {
        std::vector<EyeRequest> eyes{{.pose = pose, .width = 80, .height = 48}};
        for (uint32_t i = 1; i <= others_; ++i)
            eyes.push_back({.pose = lookAt({2.0f + float(i), 3, 14}, {0, 0, 0}, 0.9f), .width = 80, .height = 48});
        submitAndWait(renderer_, submission_, Simulation(scene), eyes);
        const PictureView& picture = submission_.pictures().front();
        return {picture.bytes, picture.bytes + picture.layout.bytes()};
    }

private:
    Renderer renderer_;
    Submission submission_;
    uint32_t others_;
};

class AmongOthersTest : public GpuTest {
protected:
    static constexpr uint32_t kOthers = 15;

    struct Way {
        std::string method, shadows;
        bool parity;
        std::string name() const { return method + ", " + shadows + (parity ? ", parity" : ""); }
    };
    // Objects, and a lamp whose shadows they cast into the fog.
    static Scene sceneBy(const Way& way) {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
        scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
        scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}};
        // What is lit ends with these, wherever the lamp is: the grid of shadows stays as it is.
        scene.spheres = {{{-20, -20, -20}, 0.1f, glm::vec3(0)}, {{20, 20, 20}, 0.1f, glm::vec3(0)}};
        scene.lights = {{.type = kPoint, .position = {0.5f, 2.5f, 2}, .intensity = {90, 80, 60}}};
        scene.render.method = way.method;
        scene.render.froxels = {.pixels = 4, .slices = 64, .shadows = way.shadows};
        scene.render.shadow_grid.voxel = 0.4f;
        scene.render.shadow_grid.parity = way.parity;
        scene.render.radiance.spacing = 0.4f;
        return scene;
    }
    static Scene moved(Scene scene, float by) {
        scene.lights[0].position += glm::vec3(-by, 0.2f * by, 0.5f * by);
        return scene;
    }
};

const Pose kAhead = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kAside = lookAt({2, 3, 14}, {9, 1, 0}, 0.5f);

// Also while the lamp moves. With parity half of the grid is that of the tick before, and the same half for each of
// both: a viewer whose view rests has had all that is in it made since the first picture.
TEST_F(AmongOthersTest, AViewerSeesTheSame) {
    for (const Way& way : {Way{"froxels", "ray", false}, Way{"froxels", "map", false}, Way{"froxels", "grid", false},
                           Way{"froxels", "grid", true}, Way{"froxels", "hybrid", false},
                           Way{"froxels", "hybrid", true}, Way{"lit", "ray", false}, Way{"gradients", "ray", false}}) {
        const Scene scene = sceneBy(way);
        Watched alone(device(), scene, 0), among(device(), scene, kOthers);
        std::vector<uint8_t> before;
        for (const float by : {0.0f, 0.0f, 0.6f, 1.2f, 1.8f, 1.8f}) {
            const std::vector<uint8_t> picture = alone.see(moved(scene, by), kAhead);
            EXPECT_TRUE(picture == among.see(moved(scene, by), kAhead)) << way.name() << ", moved by " << by;
            EXPECT_TRUE(by == 0 || by == 1.8f || picture != before) << way.name() << ": nothing moves";
            before = picture;
        }
    }
}

// A viewer turns to what the others already look at, as the lamp moves. Without parity the picture is the same. With
// parity half of what the others had made is older, until the tick after: then it is the same again.
TEST_F(AmongOthersTest, WhoTurnsToWhatOthersSeeSeesTheSame) {
    for (const Way& way : {Way{"froxels", "grid", false}, Way{"froxels", "hybrid", false}, Way{"froxels", "grid", true},
                           Way{"froxels", "hybrid", true}}) {
        const Scene scene = sceneBy(way), after = moved(scene, 1.2f);
        Watched alone(device(), scene, 0), among(device(), scene, kOthers);
        alone.see(scene, kAside);
        among.see(scene, kAside);
        const bool same = alone.see(after, kAhead) == among.see(after, kAhead);
        EXPECT_EQ(same, !way.parity) << way.name();
        const std::vector<uint8_t> settled = alone.see(after, kAhead);
        EXPECT_TRUE(settled == among.see(after, kAhead)) << way.name() << ", a tick later";
        EXPECT_TRUE(settled == Watched(device(), after, 0).see(after, kAhead)) << way.name() << ", as made anew";
    }
}

} // namespace
} // namespace brume::test::among_others_test
