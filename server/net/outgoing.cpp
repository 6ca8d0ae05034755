#include "server/net/outgoing.h"

#include "server/net/convert.h"
#include "server/sim/simulation.h"

namespace brume::net {
namespace {

using Builder = flatbuffers::FlatBufferBuilder;

auto packStrings(Builder& b, const std::vector<std::string>& strings) { return b.CreateVectorOfStrings(strings); }
auto packText(Builder& b, std::string_view text) { return b.CreateString(text.data(), text.size()); }

auto packPlan(Builder& b, const SceneReport& report) {
    const RenderSettings& used = report.plan.settings;
    const auto method = packText(b, used.method), quadrature = packText(b, used.quadrature);
    return wire::CreatePlan(b, method, quadrature, used.rate, used.slabs, float(report.plan.error),
                            float(report.plan.ms), report.plan.relaxed);
}

} // namespace

wire::Packed packWelcome(const Viewer& viewer, const PoseRequest& granted, const Audience& audience, wire::Role role) {
    return wire::pack([&](Builder& b) {
        const SceneFacts& facts = audience.facts();
        const wire::Vec3 position = toWire(facts.camera.position), target = toWire(facts.camera.target);
        const auto camera = wire::CreateCamera(b, &position, &target, facts.camera.fov_y);
        const auto server = b.CreateString("brume " BRUME_VERSION);
        const auto scene = packText(b, facts.scene), device = packText(b, facts.device);
        const auto methods = packStrings(b, facts.methods), quadratures = packStrings(b, facts.quadratures);
        const auto resume = packText(b, viewer.key());
        return wire::CreateWelcome(b, viewer.id(), server, scene, device, granted.width, granted.height, granted.views,
                                   float(1 / kTickSeconds), uint8_t(std::min(audience.maxInFlight(), 255u)), camera,
                                   methods, quadratures, resume, viewer.resumed(), role);
    });
}

wire::Packed packSceneState(const SceneReport& report, uint32_t viewers) {
    return wire::pack([&](Builder& b) {
        const wire::Vec3 to_light = toWire(report.light.to_light), irradiance = toWire(report.light.irradiance);
        const wire::Vec3 albedo = toWire(report.medium.albedo);
        const auto method = packText(b, report.render.method), quadrature = packText(b, report.render.quadrature);
        std::vector<flatbuffers::Offset<wire::PassTime>> passes;
        passes.reserve(report.passes.size());
        for (const PassTime& pass : report.passes)
            passes.push_back(wire::CreatePassTime(b, packText(b, pass.name), pass.ms));
        const auto packed_passes = b.CreateVector(passes);
        const auto plan = packPlan(b, report);
        return wire::CreateSceneState(b, report.tick, report.state_hash, viewers, report.particles, report.paused,
                                      &to_light, &irradiance, report.light.rotate, report.medium.extinction,
                                      report.medium.falloff, report.medium.anisotropy, report.medium.asymmetry, &albedo,
                                      method, quadrature, report.render.steps, report.render.exposure, packed_passes,
                                      plan);
    });
}

wire::Packed packFrameHeader(const EncodedFrame& frame, float queue_ms) {
    return wire::pack([&](Builder& b) {
        const PoseRequest& request = frame.request;
        const wire::Vec3 position = toWire(request.pose.position);
        const wire::Quat orientation = toWire(request.pose.orientation);
        const wire::Stages stages(frame.wait_ms, frame.render_ms, frame.encode_ms, queue_ms, frame.gpu_ms);
        uint32_t lengths[wire::kMaxViews];
        for (uint32_t view = 0; view < request.views; ++view) lengths[view] = uint32_t(frame.jpeg[view]->size());
        const auto jpeg_bytes = b.CreateVector(lengths, request.views);
        wire::Frustum drawn[wire::kMaxViews];
        const wire::Frustum* frusta[wire::kMaxViews]{};
        for (int view = 0; view < request.views; ++view) {
            const Pose eye = eyePose(request.pose, view, request.views);
            if (eye.frustum == Frustum{}) continue;
            drawn[view] = toWire(frustumOf(eye, request.width, request.height));
            frusta[view] = &drawn[view];
        }
        return wire::CreateFrame(b, frame.id, frame.tick, frame.state_hash, request.seq, request.client_time_us,
                                 &position, &orientation, request.pose.fov_y, request.width, request.height,
                                 request.quality, &stages, jpeg_bytes, frusta[0], frusta[1],
                                 frame.png ? wire::Encoding::png : wire::Encoding::jpeg);
    });
}

wire::Packed packError(wire::ErrorCode code, std::string_view text, uint32_t input_seq) {
    return wire::pack([&](Builder& b) { return wire::CreateError(b, code, packText(b, text), input_seq); });
}

wire::Packed packGoodbye(std::string_view reason, float retry_after_s, std::string_view go_to) {
    return wire::pack([&](Builder& b) {
        const auto text = packText(b, reason);
        return wire::CreateGoodbye(b, text, retry_after_s, go_to.empty() ? 0 : packText(b, go_to));
    });
}

wire::Packed packPing(uint32_t nonce, uint64_t time_us) {
    return wire::pack([&](Builder& b) { return wire::CreatePing(b, nonce, time_us); });
}

wire::Packed packPong(uint32_t nonce, uint64_t time_us) {
    return wire::pack([&](Builder& b) { return wire::CreatePong(b, nonce, time_us); });
}

} // namespace brume::net
