// brume-claims: measures, in one run on this machine, what the README says about speed and error. Prints Markdown.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/cores.h"
#include "common/option_range.h"
#include "common/process.h"
#include "server/encode/jpeg.h"
#include "server/inputs/tick_block.h"
#include "server/render/renderer.h"
#include "tools/bench/error.h"
#include "tools/bench/passes.h"
#include "tools/reference/medium_reference.h"

namespace brume {
namespace {

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

double threadCpuMs() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) * 1e3 + double(t.tv_nsec) * 1e-6;
}

struct Size {
    uint32_t width, height;
};

struct Variant {
    const char* name;
    const char* method;
    const char* quadrature;
    uint32_t steps;
};
constexpr Variant kVariants[] = {
    {"isv, Simpson 1", "isv", "simpson", 1},   {"isv, Simpson 2", "isv", "simpson", 2},
    {"isv, Simpson 10", "isv", "simpson", 10}, {"isv, transmittance space 2", "isv", "transmittance", 2},
    {"isv, analytic", "isv", "analytic", 1},   {"sphere, Gauss-Hermite 2", "sphere", "simpson", 2},
};

Scene withVariant(Scene scene, const Variant& v) {
    scene.render.method = v.method;
    scene.render.isv.quadrature = v.quadrature;
    scene.render.isv.steps = v.steps;
    return scene;
}

// One scene's renderer that can be asked again and again.
struct Bench {
    Simulation simulation;
    Renderer renderer;
    Submission submission;
    Bench(const gpu::Device& device, const Scene& scene)
        : simulation(scene), renderer(device, scene, simulation.capacity()), submission(device, "bench") {}

    std::span<const gpu::PassSample> render(const EyeRequest& eye) {
        renderer.forget(); // a frame costs what one of a medium that moves does
        renderer.submit(submission, simulation, {&eye, 1});
        while (!submission.commands.wait(1'000'000'000)) {
        }
        return submission.commands.readTimes();
    }
};

double mediumMs(std::span<const gpu::PassSample> passes) {
    double sum = 0;
    for (const gpu::PassSample& pass : passes)
        if (pass.view != gpu::kShared && bench::ofMedium(pass.name)) sum += pass.ms;
    return sum;
}

double error(Bench& bench, const Scene& scene, reference::Model model, const Pose& pose, Size size) {
    static std::map<reference::Model, RadianceImage> exact; // one scene and camera in this program
    std::vector<gpu::Particle> particles(bench.simulation.liveCount());
    bench.simulation.write(particles);
    if (!exact.contains(model)) {
        const Light light = sunOf(scene);
        const reference::Picture picture =
            reference::render({particles, scene.medium.falloff, scene.medium.anisotropy, scene.medium.asymmetry}, light,
                              pose, int(size.width), int(size.height), model);
        RadianceImage& image = exact[model] = {picture.width, picture.height, {}, {}};
        image.radiance.assign(picture.radiance.begin(), picture.radiance.end());
        image.transmittance.assign(picture.transmittance.begin(), picture.transmittance.end());
    }
    bench.renderer.keepRadiance(true);
    bench.render({pose, size.width, size.height});
    RadianceImage got{int(size.width), int(size.height), {}, {}};
    for (const glm::vec4& pixel : bench.renderer.readRadiance())
        got.radiance.emplace_back(pixel), got.transmittance.push_back(pixel.a);
    return bench::mediumError(got, exact[model], {}).medium.relative_rmse;
}

void methodTable(const gpu::Device& device, Scene scene, int rounds, Size size) {
    scene.sky = {glm::vec3(0), glm::vec3(0), glm::vec3(0)}; // radiance is then the medium's alone
    const Pose pose = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
    std::vector<std::unique_ptr<Bench>> benches;
    for (const Variant& v : kVariants) benches.push_back(std::make_unique<Bench>(device, withVariant(scene, v)));
    std::vector<std::vector<double>> times(std::size(kVariants));
    std::vector<double> shadow;
    for (int round = 0; round <= rounds; ++round) // interleaved: what disturbs the machine disturbs all alike
        for (size_t i = 0; i < benches.size(); ++i) {
            const auto passes = benches[i]->render({pose, size.width, size.height});
            if (round == 0) continue; // compiles shaders
            times[i].push_back(mediumMs(passes));
            for (const gpu::PassSample& pass : passes)
                if (std::string_view(pass.name) == "shadow volume") shadow.push_back(pass.ms);
        }
    const double base = median(times[1]);
    const Size compared{size.width / 4, size.height / 4};
    std::printf("## Methods: scene `%s`, %ux%u, medium passes (cull, sort, draw), median of %d interleaved frames\n\n",
                scene.name.c_str(), size.width, size.height, rounds);
    std::printf("Error: relative RMSE of radiance at %ux%u against the double-precision reference: the true "
                "overlapping medium, and the\n"
                "sequential one (particles composited one after another) with the same support.\n\n",
                compared.width, compared.height);
    std::printf("| method | ms | Simpson-2 time over this | against overlapping | against sequential, same support "
                "|\n|---|---|---|---|---|\n");
    for (size_t i = 0; i < benches.size(); ++i) {
        const bool sphere = std::string_view(kVariants[i].method) == "sphere";
        const double overlapping = error(*benches[i], scene, reference::Model::overlapping, pose, compared);
        const double sequential =
            error(*benches[i], scene, sphere ? reference::Model::sequential : reference::Model::sequential_tetrahedron,
                  pose, compared);
        std::printf("| %s | %.1f | %.2f | %.2f %% | %.2f %% |\n", kVariants[i].name, median(times[i]),
                    base / median(times[i]), 100 * overlapping, 100 * sequential);
    }
    const Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    const gpu::Tick tick = makeTick(scene, simulation.now(), particles, {});
    std::printf("\nVolumetric shadow map %ux%ux%u: %.1f ms, once per tick for all viewers.\n\n", tick.map.texels.x,
                tick.map.texels.y, tick.map.slices, median(shadow));
}

void ownTime(const gpu::Device& device, const Scene& scene, int rounds) {
    Bench bench(device, scene);
    const EyeRequest eye{lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y), 640, 360};
    bench.render(eye);
    std::vector<double> spent;
    for (int i = 0; i < rounds; ++i) {
        const double begin = threadCpuMs();
        bench.simulation.step({});
        bench.renderer.submit(bench.submission, bench.simulation, {&eye, 1});
        const double recorded = threadCpuMs();
        while (!bench.submission.commands.wait(1'000'000'000)) {
        }
        const double done = threadCpuMs();
        (void)bench.submission.commands.readTimes();
        (void)bench.submission.pictures();
        spent.push_back(recorded - begin + threadCpuMs() - done);
    }
    std::printf(
        "## The server's own work per frame\n\nStep, light bounds, upload, recording and submission of one 640x360 "
        "viewer of `%s`, CPU time of the\n"
        "frame thread outside GPU passes and JPEG, median of %d: **%.2f ms**.\n\n",
        scene.name.c_str(), rounds, median(spent));
}

// Frames a second of our encoder and of libjpeg-turbo's tjbench, on the same picture, in turns of `run` seconds.
void jpeg(const gpu::Device& device, const Scene& scene, double run) {
    Bench bench(device, scene);
    bench.render({lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y), 640, 360});
    const PictureView picture = bench.submission.pictures()[0];
    const PlaneLayout& layout = picture.layout;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("brume-claims-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const std::string ppm = (folder / "picture.ppm").string();
    {
        std::ofstream out(ppm, std::ios::binary);
        out << "P6\n" << layout.width << ' ' << layout.height << "\n255\n";
        for (uint32_t y = 0; y < layout.height; ++y)
            for (uint32_t x = 0; x < layout.width; ++x) {
                const uint8_t* chroma =
                    picture.bytes + layout.lumaBytes() + size_t(y / 2) * layout.chromaStride() + x / 2;
                const double luma = picture.bytes[y * layout.lumaStride() + x], cb = chroma[0] - 128.0,
                             cr = chroma[layout.chromaBytes()] - 128.0;
                for (const double c : {luma + 1.402 * cr, luma - 0.344136 * cb - 0.714136 * cr, luma + 1.772 * cb})
                    out.put(char(std::clamp(int(c + 0.5), 0, 255)));
            }
    }
    JpegEncoder encoder;
    std::vector<double> ours, theirs;
    size_t bytes = 0;
    for (int round = 0; round < 5; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        int frames = 0;
        double seconds = 0;
        for (; seconds < run; ++frames) {
            bytes = encoder.encode(picture, 80).size();
            seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        }
        ours.push_back(frames / seconds);
        Process tjbench({"/usr/bin/env", "tjbench", ppm, "80", "-yuv", "-subsamp", "420", "-benchtime",
                         std::to_string(run), "-warmup", "0.2", "-nowrite", "-componly"});
        tjbench.exitCode();
        const std::string text = tjbench.out();
        std::smatch found;
        if (std::regex_search(text, found, std::regex("Comp from YUV[^\\n]*Frame rate:\\s+([0-9.]+)")))
            theirs.push_back(std::stod(found[1]));
    }
    std::filesystem::remove_all(folder);
    std::printf("## JPEG: 640x360, quality 80, 4:2:0 planes, %zu bytes\n\n", bytes);
    if (theirs.empty()) {
        std::printf("Ours: %.0f frames/s. tjbench is not installed (libjpeg-turbo-progs), so there is nothing to "
                    "compare with.\n\n",
                    median(ours));
        return;
    }
    std::printf("Ours %.0f frames/s, tjbench (compress from YUV planes) %.0f frames/s, medians of 5 in turns: ratio "
                "**%.2f**.\n\n",
                median(ours), median(theirs), median(ours) / median(theirs));
}

// Frames per second, all clients together, of `servers` servers with `clients` clients each.
double streamed(const std::filesystem::path& bin, const std::string& scene, int servers, int clients, double seconds) {
    std::vector<std::unique_ptr<Process>> running, watching;
    std::vector<std::filesystem::path> folders;
    std::vector<std::string> ports;
    for (int s = 0; s < servers; ++s)
        running.push_back(std::make_unique<Process>(
            std::vector<std::string>{(bin / "brume-server").string(), "--scene", scene, "--port", "0"}));
    for (const auto& server : running)
        ports.push_back(server->lineStarting("listening on http://127.0.0.1:", std::chrono::minutes(2)).value());
    for (const std::string& port : ports)
        for (int c = 0; c < clients; ++c) {
            folders.push_back(std::filesystem::temp_directory_path() /
                              ("brume-claims-" + std::to_string(::getpid()) + "-" + std::to_string(folders.size())));
            watching.push_back(std::make_unique<Process>(std::vector<std::string>{
                (bin / "brume-client").string(), "--headless", "--url", "ws://127.0.0.1:" + port, "--size", "640x360",
                "--path", "orbit", "--seconds", std::to_string(seconds), "--out", folders.back().string(), "--no-save",
                "--timeout", "60"}));
        }
    double rate = 0;
    for (size_t i = 0; i < watching.size(); ++i) {
        watching[i]->exitCode(std::chrono::minutes(3));
        std::ifstream in(folders[i] / "stats.json");
        rate += nlohmann::json::parse(in).at("frame_rate").get<double>();
        std::filesystem::remove_all(folders[i]);
    }
    return rate;
}

void viewers(const std::filesystem::path& bin, const std::string& scene, double seconds) {
    std::vector<double> one, many;
    for (int round = 0; round < 3; ++round) {
        one.push_back(streamed(bin, scene, 1, 4, seconds));
        many.push_back(streamed(bin, scene, 4, 1, seconds));
    }
    std::printf("## Four viewers of one server against four servers with one viewer each\n\nScene `%s`, 640x360, "
                "real processes and sockets, all on this machine, %.0f s, medians of 3 in turns; frames/s of all "
                "four together.\n\n",
                scene.c_str(), seconds);
    std::printf("| one server | four servers | ratio |\n|---|---|---|\n| %.1f | %.1f | **%.2f** |\n\n", median(one),
                median(many), median(one) / median(many));
}

} // namespace
} // namespace brume

int main(int argc, char** argv) {
    using namespace brume;
    int rounds = 15;
    double seconds = 10, jpeg_seconds = 1; // of a run
    Size size{640, 360};
    std::string scene_name = "cloud", device_name;
    CLI::App app{"brume-claims: measures what the README says about speed and error, in one run; prints Markdown."};
    app.set_version_flag("--version", "brume-claims " BRUME_VERSION);
    allow(app.add_option("--rounds", rounds, "frames per method")->capture_default_str(), 1, 1000);
    allow(app.add_option("--seconds", seconds, "of each streaming run; 0 leaves streaming out")->capture_default_str(),
          0.0, 600.0);
    allow(app.add_option("--jpeg-seconds", jpeg_seconds, "of each run of an encoder")->capture_default_str(), 0.01,
          60.0);
    allow(app.add_option("--width", size.width, "of the pictures of methods, in 16:9")->capture_default_str(), 64,
          3840);
    app.add_option("--scene", scene_name, "a shipped scene")->capture_default_str();
    app.add_option("--device", device_name, "part of the Vulkan device's name");
    CLI11_PARSE(app, argc, argv);
    size.height = size.width * 9 / 16;
    try {
        const std::filesystem::path bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
        Scene scene = loadScene(findScene(scene_name, BRUME_SCENES));
        if (!checkSettings(scene.render).empty()) scene.render.method = methodNames().front(); // auto is the server's
        {
            gpu::DeviceOptions options;
            options.name = device_name;
            const gpu::Device device(options);
            std::printf("# Measured claims\n\nDevice: %s. CPU threads: %u.\n\n", device.name().c_str(), usableCores());
            methodTable(device, scene, rounds, size);
            ownTime(device, scene, rounds);
            jpeg(device, scene, jpeg_seconds);
        }
        std::fflush(stdout);
        if (seconds > 0) viewers(bin, scene_name, seconds);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "brume-claims: " << e.what() << '\n';
        return 1;
    }
}
