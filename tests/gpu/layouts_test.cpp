// The shader sees every member of the shared structs where C++ has it.
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "server/gpu/specialize.h"
#include "server/gpu/variants.h"
#include "tests/gpu/fixture.h"

// After it: the words of a shader need <cstdint>.
#include "shaders/background_frag.h"
#include "shaders/background_vert.h"
#include "shaders/compose_comp.h"
#include "shaders/shadow_particles_comp.h"
#include "shaders/slabs_comp.h"
#include "shaders/sort_scan_comp.h"
#include "test_shaders/layouts_comp.h"
#include "test_shaders/tiny_numbers_comp.h"

namespace brume::test::layouts_test {
namespace {

using namespace gpu;

TEST_F(GpuTest, SharedStructsLieAlike) {
    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    // A buffer of two structs whose words count from `first`; what the shader reads tells where it looked.
    const auto counting = [&](size_t bytes, uint32_t first) {
        Buffer buffer(device(), bytes, kUsage, Memory::upload, "counting");
        const auto words = buffer.mapped<uint32_t>(bytes / 4);
        std::iota(words.begin(), words.end(), first);
        return buffer;
    };
    const Buffer tick = counting(sizeof(Tick), 1000), eye = counting(sizeof(Eye), 2000),
                 particles = counting(2 * sizeof(Particle), 3000), objects = counting(2 * sizeof(Opaque), 4000),
                 light = counting(2 * sizeof(LightParticle), 5000), arguments = counting(sizeof(DrawArguments), 6000),
                 views = counting(2 * sizeof(View), 7000);
    std::vector<uint32_t> expected;
    const auto expect = [&](uint32_t first, std::initializer_list<size_t> offsets) {
        for (const size_t offset : offsets) expected.push_back(first + uint32_t(offset / 4));
    };
#define AT(Struct, member) offsetof(Struct, member)
    expect(1000, {AT(Tick, sun.to_light), AT(Tick, falloff),         AT(Tick, map.x),          AT(Tick, phase.part),
                  AT(Tick, map.y),        AT(Tick, phase.second),    AT(Tick, sun.irradiance), AT(Tick, cut),
                  AT(Tick, ambient),      AT(Tick, particle_count),  AT(Tick, map.lo),         AT(Tick, map.slices),
                  AT(Tick, map.hi),       AT(Tick, map.opaque_size), AT(Tick, map.opaque_lo),  AT(Tick, map.opaque_hi),
                  AT(Tick, map.texels),   AT(Tick, opaque_count),    AT(Tick, sky_zenith),     AT(Tick, sky_horizon),
                  AT(Tick, haze),         AT(Tick, map.u),           AT(Tick, map.v),          AT(Tick, map.plane)});
    expect(2000, {AT(Eye, position), AT(Eye, near_depth), AT(Eye, right), AT(Eye, tan_x), AT(Eye, up), AT(Eye, tan_y),
                  AT(Eye, back), AT(Eye, exposure), AT(Eye, size), AT(Eye, filmic), AT(Eye, ray), AT(Eye, ray_right),
                  AT(Eye, ray_down)});
    const auto second = [&](uint32_t first, size_t size, std::initializer_list<size_t> offsets) {
        expect(first + uint32_t(size / 4), offsets);
    };
    second(3000, sizeof(Particle),
           {AT(Particle, centre), AT(Particle, scale), AT(Particle, albedo), AT(Particle, sigma_t)});
    second(4000, sizeof(Opaque),
           {AT(Opaque, centre), AT(Opaque, kind), AT(Opaque, half_size), AT(Opaque, yaw_cos), AT(Opaque, albedo),
            AT(Opaque, yaw_sin)});
    second(5000, sizeof(LightParticle), {AT(LightParticle, at), AT(LightParticle, k), AT(LightParticle, reach)});
    second(7000, sizeof(View),
           {AT(View, eye),
            AT(View, map_rays.eye),
            AT(View, map_rays.ray),
            AT(View, map_rays.right),
            AT(View, map_rays.down),
            AT(View, grid.nodes),
            AT(View, grid.margin),
            AT(View, grid.first_row),
            AT(View, grid.rate),
            AT(View, grid.depth),
            AT(View, grid.thickness),
            AT(View, grid.slabs),
            AT(View, grid.sheet),
            AT(View, grid.lines),
            AT(View, grid.caster_words),
            AT(View, grid.albedo),
            AT(View, first),
            AT(View, end),
            AT(View, planes),
            AT(View, members),
            AT(View, bins),
            AT(View, added),
            AT(View, field),
            AT(View, shaded)});
    expect(6000, {AT(DrawArguments, vertex_count), AT(DrawArguments, instance_count), AT(DrawArguments, first_vertex),
                  AT(DrawArguments, first_instance), AT(DrawArguments, groups_x), AT(DrawArguments, groups_y),
                  AT(DrawArguments, groups_z)});
#undef AT

    const Buffer words(device(), expected.size() * 4, kUsage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::readback,
                       "words");
    const ComputeProgram program(device(), {VK_SHADER_STAGE_COMPUTE_BIT, layouts_comp, "layouts"});
    Commands commands(device(), "layouts");
    const VkCommandBuffer cmd = commands.begin();
    program.bind(commands,
                 {uniformBuffer("TickBlock", tick, 0, sizeof(Tick)), uniformBuffer("EyeBlock", eye, 0, sizeof(Eye)),
                  storageBuffer("Particles", particles), storageBuffer("Objects", objects),
                  storageBuffer("LightParticles", light), storageBuffer("Arguments", arguments),
                  storageBuffer("Words", words), storageBuffer("Views", views)});
    vkCmdDispatch(cmd, 1, 1, 1);
    commands.submit();
    waitFor(commands);
    words.invalidate();
    const auto got = words.mapped<uint32_t>(expected.size());
    EXPECT_EQ(std::vector<uint32_t>(got.begin(), got.end()), expected);
}

#if defined(__SSE2__)
// Numbers below the normal range are zero: x86 adds them up to a hundred times as slowly as others.
TEST_F(GpuTest, TinyNumbersAreZeroOnCpuDrivers) {
    if (!device().isCpu()) GTEST_SKIP() << "a GPU: it may keep them, it adds them fast";
    constexpr VkDeviceSize kBytes = 8 * sizeof(float);
    const auto make = [&](const char* name) {
        return Buffer(device(), kBytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Memory::readback, name);
    };
    const Buffer numbers = make("numbers"), squares = make("squares");
    for (float& number : numbers.mapped<float>(8)) number = 1e-20f;
    numbers.mapped<float>(8)[7] = 1e-18f; // its square is normal
    numbers.flush();
    const ComputeProgram program(device(), {VK_SHADER_STAGE_COMPUTE_BIT, tiny_numbers_comp, "tiny_numbers"});
    Commands commands(device(), "tiny numbers");
    const VkCommandBuffer cmd = commands.begin();
    program.bind(commands, {storageBuffer("Numbers", numbers), storageBuffer("Squares", squares)});
    vkCmdDispatch(cmd, 1, 1, 1);
    commands.submit();
    waitFor(commands);
    squares.invalidate();
    for (int i = 0; i < 7; ++i) EXPECT_EQ(squares.mapped<float>(8)[size_t(i)], 0) << i;
    EXPECT_FLOAT_EQ(squares.mapped<float>(8)[7], 1e-36f);
    volatile float own = 1e-20f; // this thread keeps its mode
    EXPECT_GT(own * own, 0);
}
#endif

// More descriptor sets than a pool holds, in three recordings: each dispatch reads and writes what was bound for it.
TEST_F(GpuTest, EveryBindingOfARecordingIsKept) {
    constexpr uint32_t kBindings = 600, kWords = 64; // 256 bytes: any device allows such offsets
    const ComputeProgram program(device(), {VK_SHADER_STAGE_COMPUTE_BIT, sort_scan_comp, "sort_scan"});
    const Buffer buffer(device(), VkDeviceSize(kBindings) * kWords * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                        Memory::readback, "counts");
    Commands commands(device(), "many bindings");
    for (uint32_t recording = 0; recording < 3; ++recording) {
        const auto words = buffer.mapped<uint32_t>(size_t(kBindings) * kWords);
        for (uint32_t i = 0; i < words.size(); ++i) words[i] = i % kWords < 2 ? i / kWords + recording : 0;
        buffer.flush();
        const VkCommandBuffer cmd = commands.begin();
        for (uint32_t i = 0; i < kBindings; ++i) {
            program.bind(commands,
                         {storageBuffer("Histogram", buffer, VkDeviceSize(i) * kWords * 4, VkDeviceSize(kWords) * 4)},
                         kWords);
            vkCmdDispatch(cmd, 1, 1, 1);
        }
        commands.submit();
        waitFor(commands);
        buffer.invalidate();
        for (uint32_t i = 0; i < kBindings; ++i) { // sums of the words before
            ASSERT_EQ(words[size_t(i) * kWords], 0u) << i;
            ASSERT_EQ(words[size_t(i) * kWords + 1], i + recording) << i;
            ASSERT_EQ(words[size_t(i) * kWords + kWords - 1], 2 * (i + recording)) << i;
        }
    }
}

// The text of the Error that `action` throws; empty if it throws none.
template <class Action>
std::string refusal(Action action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST_F(GpuTest, AProgramRefusesConstantsThatNoneOfItsShadersHas) {
    const ShaderCode slabs{VK_SHADER_STAGE_COMPUTE_BIT, slabs_comp, "slabs"};
    EXPECT_NO_THROW(ComputeProgram(device(), slabs, {{kIdLanes, 8}})); // the size of its workgroups
    const auto unknown_id = [&] { ComputeProgram(device(), slabs, {{kIdLanes, 8}, {kIdStep, 4}}); };
    EXPECT_EQ(refusal(unknown_id),
              fmt::format("slabs: no shader has a specialization constant with the id {} (shaders/shared/constants.h)",
                          uint32_t{kIdStep}));

    // Of two stages, one that has the constant is enough.
    const ShaderCode stages[] = {{VK_SHADER_STAGE_VERTEX_BIT, background_vert, "background"},
                                 {VK_SHADER_STAGE_FRAGMENT_BIT, background_frag, "background"}};
    GraphicsInfo info;
    info.formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_SFLOAT};
    info.blend = Blend::replace;
    const SpecConstant known[] = {{kIdPlanes, 1}, {kIdBoxes, 0}}, unknown[] = {{kIdPlanes, 1}, {kIdHasOpaque, 0}};
    EXPECT_NO_THROW(GraphicsProgram(device(), stages, info, known));
    EXPECT_THROW(GraphicsProgram(device(), stages, info, unknown), Error);
}

TEST_F(GpuTest, VariantsTakeOfWhatIsOfferedWhatTheirShadersHave) {
    Variants variants(device(), shadow_particles_comp, "shadow_particles");
    const Constants offered{{kIdHasFog, 1}, {kIdLanes, 2}};
    const Program& two = variants.with(offered);
    EXPECT_EQ(&variants.with({{kIdLanes, 2}}), &two) << "fog means nothing to it";
    const Program& four = variants.with(offered, {{kIdLanes, 4}});
    EXPECT_NE(&four, &two);
    EXPECT_EQ(&variants.with({{kIdLanes, 4}}), &four) << "its own value counts";
    EXPECT_NE(refusal([&] {
                  variants.with({{kIdHasFog, 1}});
              }).find("shadow_particles: no shader has"),
              std::string::npos);
}

// Opcodes of the instructions of a SPIR-V module.
std::vector<uint32_t> opcodes(std::span<const uint32_t> words) {
    std::vector<uint32_t> all;
    constexpr size_t kHeader = 5;
    for (size_t i = kHeader; i < words.size() && words[i] >> 16 > 0; i += words[i] >> 16)
        all.push_back(words[i] & 0xFFFF);
    return all;
}

TEST(Specialize, LeavesNoConstantToBeSetAndNothingThatIsNeverRun) {
    constexpr uint32_t kFirst = 48, kLast = 52, kFunction = 54; // OpSpecConstantTrue, OpSpecConstantOp, OpFunction
    const auto count = [](const std::vector<uint32_t>& all, uint32_t first, uint32_t last) {
        return std::ranges::count_if(all, [&](uint32_t code) { return code >= first && code <= last; });
    };
    const ShaderCode compose{VK_SHADER_STAGE_COMPUTE_BIT, compose_comp, "compose"};
    const std::vector<uint32_t> before = opcodes(compose.words);
    const auto with = [&](uint32_t objects) {
        const SpecConstant constants[] = {{kIdHasOpaque, objects}, {kIdHasCasters, objects}};
        return opcodes(specialized(compose, constants));
    };
    const std::vector<uint32_t> some = with(1), none = with(0);
    EXPECT_GT(count(before, kFirst, kLast), 10);
    EXPECT_EQ(count(some, kFirst, kLast), 0);
    EXPECT_EQ(count(none, kFirst, kLast), 0);
    EXPECT_LT(some.size(), before.size()); // other constants have their defaults
    EXPECT_LT(count(none, kFunction, kFunction), count(some, kFunction, kFunction));

    const uint32_t nonsense[] = {1, 2, 3};
    EXPECT_THROW(specialized({VK_SHADER_STAGE_COMPUTE_BIT, nonsense, "nonsense"}, {}), Error);
}

TEST_F(GpuTest, AProgramRefusesBuffersLargerThanTheDeviceCanBind) {
    const ComputeProgram program(device(), {VK_SHADER_STAGE_COMPUTE_BIT, shadow_particles_comp, "shadow_particles"});
    const VkDeviceSize storage = device().properties().limits.maxStorageBufferRange,
                       uniform = device().properties().limits.maxUniformBufferRange;
    const auto tooLarge = [](const std::string& what, VkDeviceSize most) {
        return "shadow_particles: " + what + " of " + std::to_string(most + 1) + " bytes, the device allows " +
               std::to_string(most) + "; use fewer particles or smaller pictures";
    };
    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    const Buffer buffer(device(), 256, kUsage, Memory::device, "some");
    EXPECT_EQ(storageBuffer("Some", buffer, 16).buffer.range, 240u);

    Commands commands(device(), "too large");
    commands.begin();
    const auto bind = [&](VkDeviceSize tick, VkDeviceSize particles) { // bytes; nothing is dispatched
        const glm::uvec3 push{};
        program.bind(commands,
                     {uniformBuffer("TickBlock", buffer, 0, tick), storageBuffer("Particles", buffer, 0, particles),
                      storageBuffer("LightParticles", buffer), storageBuffer("Bins", buffer),
                      storageBuffer("Axes", buffer), storageBuffer("LightSkews", buffer)},
                     push);
    };
    EXPECT_NO_THROW(bind(256, 256));
    EXPECT_EQ(refusal([&] { bind(256, storage + 1); }), tooLarge("storage buffer 'Particles'", storage));
    EXPECT_EQ(refusal([&] { bind(uniform + 1, 256); }), tooLarge("uniform buffer 'TickBlock'", uniform));
    commands.submit();
    waitFor(commands);
}

TEST_F(GpuTest, ABufferIsReplacedOnlyByALargerOne) {
    Buffer buffer;
    const auto fit = [&](VkDeviceSize bytes) {
        buffer.atLeast(device(), bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Memory::upload, "some");
        return buffer.handle();
    };
    EXPECT_EQ(fit(0), VkBuffer{}); // no buffer holds nothing
    const VkBuffer first = fit(256);
    buffer.mapped<uint32_t>(1)[0] = 7;
    EXPECT_EQ(fit(100), first);
    EXPECT_EQ(buffer.size(), 256u);
    EXPECT_EQ(buffer.mapped<uint32_t>(1)[0], 7u);
    fit(257);
    EXPECT_EQ(buffer.size(), 257u);
}

// What shaders ask for and nobody gives is told by its name. A pass's own counts before what is shared; what is too
// much is passed over.
TEST_F(GpuTest, ResourcesAreFoundByTheirNames) {
    const ComputeProgram program(device(), {VK_SHADER_STAGE_COMPUTE_BIT, tiny_numbers_comp, "tiny_numbers"});
    const Buffer buffer(device(), 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
                        Memory::device, "some");
    Commands commands(device(), "names");
    commands.begin();
    Resources outer, shared(&outer);
    const auto why = [&](std::initializer_list<Resource> own) {
        return refusal([&] { program.bind(commands, shared, own); });
    };
    outer.give(storageBuffer("Nobody's", buffer));
    EXPECT_EQ(why({storageBuffer("Squares", buffer)}), "tiny_numbers: nobody gives it the storage buffer 'Numbers'");
    outer.give(uniformBuffer("Numbers", buffer, 0, 256));
    EXPECT_EQ(why({storageBuffer("Squares", buffer)}), "tiny_numbers: nobody gives it the storage buffer 'Numbers'")
        << "of another type";
    outer.give(storageBuffer("Numbers", buffer, 0, 256));
    EXPECT_EQ(why({storageBuffer("Squares", buffer)}), "");
    EXPECT_EQ(why({}), "tiny_numbers: nobody gives it the storage buffer 'Squares'");
    shared.give(storageBuffer("Squares", buffer));
    EXPECT_EQ(why({}), "");

    const auto sizeOf = [&] { return shared.storage("Numbers").buffer.range; };
    EXPECT_EQ(sizeOf(), 256u);
    outer.give(storageBuffer("Numbers", buffer, 0, 64)); // in place of the one before
    EXPECT_EQ(sizeOf(), 64u);
    shared.give(storageBuffer("Squares", buffer, 0, 32).as("Numbers"));
    EXPECT_EQ(sizeOf(), 32u) << "the inner one counts";
    EXPECT_EQ(shared.find("numbers", VK_DESCRIPTOR_TYPE_STORAGE_BUFFER), nullptr);
    commands.submit();
    waitFor(commands);
}

} // namespace
} // namespace brume::test::layouts_test
