#include "tests/gpu/fixture.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include <unistd.h>

#include "common/ply/ply.h"
#include "common/tetrahedra.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

gpu::DeviceOptions validated(bool mesh) {
    gpu::DeviceOptions options;
    options.validation = true;
    options.mesh_shaders = mesh;
    return options;
}

// Where this program's particle files are; removed with them at its end.
class Folder {
public:
    Folder() : path_(std::filesystem::temp_directory_path() / ("brume-gpu-tests-" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::filesystem::path next() { return path_ / (std::to_string(count_++) + ".ply"); }

private:
    std::filesystem::path path_;
    int count_ = 0;
};

// What the tests of a program share. It goes with the last test, not with the program: by then the validation layer has
// gone before it.
class Shared : public testing::Environment {
public:
    std::optional<gpu::Device> device, without_mesh;
    std::optional<Stage> plain, plain_without_mesh;
    size_t next_case = 0;
    void TearDown() override {
        plain.reset();
        plain_without_mesh.reset();
        device.reset();
        without_mesh.reset();
    }
};
auto* const shared = dynamic_cast<Shared*>(testing::AddGlobalTestEnvironment(new Shared));

const gpu::Device& made(std::optional<gpu::Device>& device, bool mesh) {
    if (!device) device.emplace(validated(mesh));
    return *device;
}

Stage& made(std::optional<Stage>& stage, const gpu::Device& device, uint32_t capacity) {
    if (!stage) stage.emplace(device, sceneOf({Point{}}), capacity);
    return *stage;
}

} // namespace

GpuTest::GpuTest() {
    const auto* unit = testing::UnitTest::GetInstance();
    const testing::TestSuite& suite = *unit->current_test_suite();
    shared->next_case = 0; // the test's place in its suite
    while (suite.GetTestInfo(int(shared->next_case)) != unit->current_test_info()) ++shared->next_case;
}

size_t GpuTest::nextCase() { return shared->next_case++; }

std::vector<const char*> GpuTest::some(std::vector<const char*> methods) {
    if (whole()) return methods;
    const auto others = std::stable_partition(methods.begin(), methods.end(),
                                              [](std::string_view name) { return name == "slabs" || name == "grid"; });
    if (others == methods.end()) return methods;
    *others = others[std::ptrdiff_t(nextCase() % size_t(methods.end() - others))];
    methods.erase(others + 1, methods.end());
    return methods;
}

const gpu::Device& GpuTest::device() { return made(shared->device, true); }
const gpu::Device& GpuTest::deviceWithoutMesh() { return made(shared->without_mesh, false); }
Stage& GpuTest::plain() { return made(shared->plain, device(), kPlainCapacity); }
Stage& GpuTest::plainWithoutMesh() { return made(shared->plain_without_mesh, deviceWithoutMesh(), kPlainCapacity); }

void GpuTest::TearDown() {
    for (const std::optional<gpu::Device>* one : {&shared->device, &shared->without_mesh})
        if (*one) {
            EXPECT_EQ((*one)->validationMessages(), 0u);
        }
}

Scene sceneOf(const std::vector<Point>& points, float falloff, const std::vector<glm::uvec4>& tetrahedra) {
    static Folder folder;
    const auto file = folder.next();
    std::ofstream ply(file, std::ios::binary);
    ply << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float scale\nproperty float sigma_t\n"
           "property float red\nproperty float green\nproperty float blue\n";
    if (!tetrahedra.empty())
        ply << "element tetrahedron " << tetrahedra.size() << "\nproperty list uchar uint vertex_indices\n";
    ply << "end_header\n";
    static_assert(sizeof(Point) == 8 * sizeof(float), "a vertex of the file");
    ply.write(reinterpret_cast<const char*>(points.data()), std::streamsize(points.size() * sizeof(Point)));
    for (const glm::uvec4& cell : tetrahedra) {
        ply.put(4);
        ply.write(reinterpret_cast<const char*>(&cell), sizeof(cell));
    }
    ply.close();
    Scene scene;
    scene.name = "points";
    scene.medium.layout = Layout::file;
    scene.medium.file = file;
    scene.medium.count = uint32_t(points.size());
    scene.medium.falloff = falloff;
    Light light;
    light.to_light = glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f));
    light.irradiance = glm::vec3(1);
    scene.lights = {light};
    scene.sky = {glm::vec3(0), glm::vec3(0), glm::vec3(0)};
    scene.render.method = "sphere";
    scene.render.cutoff = 1e-6f;
    scene.render.shadow_size = 256; // tolerances presume so many
    scene.render.shadow_slices = 16;
    scene.render.tone_map = "linear";
    if (tetrahedra.empty()) return scene;
    scene.medium.model = kTetrahedraMedium;
    PointCloud read = loadPly(file, {}, {.tetrahedra = true}); // without points that no tetrahedron has
    scene.tetrahedra =
        std::make_shared<const Tetrahedra>(connected(std::move(read.tetrahedra), read.position, file.string()));
    scene.render.method = "tetrahedra";
    return scene;
}

std::vector<Point> randomPoints(uint32_t count, float extent, float scale, float sigma_t, uint32_t seed) {
    Random random(seed);
    std::vector<Point> points(count);
    for (Point& p : points)
        p = {random.inCube(extent / 2), scale * random.uniform(0.5f, 1.5f), sigma_t * random.uniform(0.5f, 1.5f)};
    return points;
}

Stage::Stage(const gpu::Device& device, const Scene& fixed, uint32_t capacity)
    : renderer_(device, fixed, capacity), submission_(device, "stage") {
    renderer_.keepRadiance(true);
    renderer_.keepMethods(16); // every way of tests/hard
}

Picture Stage::see(const Scene& scene, const Pose& pose, uint32_t width, uint32_t height) {
    const EyeRequest eye{pose, width, height};
    submitAndWait(renderer_, submission_, Simulation(scene), {&eye, 1});
    return {width, height, renderer_.readRadiance()};
}

void waitFor(const gpu::Commands& commands) {
    while (!commands.wait(1'000'000'000)) {
    }
}

void submitAndWait(Renderer& renderer, Submission& submission, const Simulation& simulation,
                   std::span<const EyeRequest> eyes) {
    renderer.submit(submission, simulation, eyes);
    waitFor(submission.commands);
}

Picture render(const gpu::Device& device, const Scene& scene, const Pose& pose, uint32_t width, uint32_t height) {
    return Stage(device, scene, Simulation(scene).capacity()).see(scene, pose, width, height);
}

glm::dvec3 pixelDirection(const Pose& pose, uint32_t width, uint32_t height, uint32_t x, uint32_t y) {
    const double tan_y = std::tan(0.5 * double(pose.fov_y)), tan_x = tan_y * width / height;
    const glm::dquat turn(pose.orientation);
    return turn * glm::dvec3(((x + 0.5) / width * 2 - 1) * tan_x, -((y + 0.5) / height * 2 - 1) * tan_y, -1);
}

std::vector<float> readImage(const gpu::Device& device, const gpu::Image& image, uint32_t channels) {
    const uint32_t layers = std::max(image.layers(), 1u);
    const size_t count = size_t(image.extent().width) * image.extent().height * layers * channels;
    const gpu::Buffer floats(device, count * sizeof(float), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                             "image readback");
    gpu::Commands commands(device, "read image");
    const VkCommandBuffer cmd = commands.begin();
    gpu::everythingBefore(cmd);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, layers};
    copy.imageExtent = {image.extent().width, image.extent().height, 1};
    vkCmdCopyImageToBuffer(cmd, image.handle(), VK_IMAGE_LAYOUT_GENERAL, floats.handle(), 1, &copy);
    gpu::transferToHost(cmd);
    commands.submit();
    waitFor(commands);
    floats.invalidate();
    const auto mapped = floats.mapped<float>(count);
    return {mapped.begin(), mapped.end()};
}

} // namespace brume::test
