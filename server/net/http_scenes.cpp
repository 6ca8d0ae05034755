// Another scene while the server runs: POST /scene?name=, POST /cloud (a PLY or NRRD file); and what there is: GET
// /scene.toml, GET /particles.ply.
#include <algorithm>

#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/string_body.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/scene_text.h"
#include "server/net/cloud_query.h"
#include "server/net/http_connection.h"
#include "server/net/particles_ply.h"
#include "server/net/path_query.h"
#include "server/net/picture_query.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

namespace http = boost::beast::http;

constexpr auto kUploadWithin = std::chrono::minutes(2);
// An upload that is slower gives its place up: kLeastPace bytes a second, once kPaceGrace has passed.
constexpr double kLeastPace = 32 << 10;
constexpr std::chrono::seconds kPaceGrace{10};
constexpr uint32_t kMostUploads = 4; // at a time; each is in memory
constexpr std::chrono::seconds kParticlesWithin{5};
constexpr auto kLoadWithin = std::chrono::minutes(2); // new shaders take a driver half a minute

// The query's `name`; nothing when there is another field than it and the token.
std::optional<std::string> nameIn(std::string_view query) {
    const auto fields = parseQuery(query);
    if (!fields) return {};
    std::string name;
    for (const auto& [key, value] : *fields) {
        if (key == "name") name = value;
        if (key != "name" && key != "token") return {};
    }
    return name;
}

// True: the sender asks for JSON.
bool wantsJson(const HttpRequest& request) {
    return request[http::field::accept].find("application/json") != std::string_view::npos;
}

// What the shown scene's points are, for people: a line, and below it one for each note.
std::string plainText(const std::string& scene, const SceneAnswer& answer) {
    std::string text = fmt::format("scene '{}' is shown", scene);
    if (answer.points > 0) text += fmt::format(": {} points", answer.points);
    if (answer.voxels.x > 0)
        text += fmt::format(": {} x {} x {} voxels", answer.voxels.x, answer.voxels.y, answer.voxels.z);
    if (answer.points > 0 || answer.voxels.x > 0)
        text += fmt::format(" in [{:.7g}, {:.7g}, {:.7g}] to [{:.7g}, {:.7g}, {:.7g}] m", answer.lo.x, answer.lo.y,
                            answer.lo.z, answer.hi.x, answer.hi.y, answer.hi.z);
    for (const std::string& note : answer.notes) text += '\n' + note;
    return text;
}

// The same for programs.
std::string jsonText(const std::string& scene, const SceneAnswer& answer) {
    nlohmann::ordered_json json{{"scene", scene}};
    if (answer.points > 0) json["points"] = answer.points;
    if (answer.voxels.x > 0) json["voxels"] = {answer.voxels.x, answer.voxels.y, answer.voxels.z};
    if (answer.points > 0 || answer.voxels.x > 0) {
        json["box"] = {{answer.lo.x, answer.lo.y, answer.lo.z}, {answer.hi.x, answer.hi.y, answer.hi.z}};
    }
    json["notes"] = answer.notes;
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

// The scene with the values that its live settings have now.
Scene tuned(const SceneFacts& facts, const SceneReport& report) {
    Scene scene = facts.scene;
    Light light = sunOf(scene);
    const SceneParts parts{.medium = &scene.medium,
                           .simulation = &scene.simulation,
                           .light = &light,
                           .sky = &scene.sky,
                           .render = &scene.render};
    for (size_t i = 0; i < report.settings.size(); ++i) apply({liveSettings()[i]->path, report.settings[i]}, parts);
    const bool had_sun = !std::ranges::all_of(scene.lights, isLocal);
    scene.lights = report.lists.lights;
    if (had_sun || light.irradiance != glm::vec3(0)) scene.lights.push_back(light);
    scene.fogs = report.lists.fogs;
    setObjects(scene, report.lists);
    return scene;
}

} // namespace

asio::awaitable<bool> HttpConnection::showScene(const HttpRequest& request, std::string_view query) {
    std::optional<std::string> name = nameIn(query);
    if (!name || name->empty())
        co_return co_await send(request, "scene", lineReply(400, "which scene? /scene?name=cumulus"));
    SceneWish wish{.name = *std::move(name), .upload = {}, .options = {}}; // GCC 12 frees an unnamed one twice
    co_return co_await change(request, "scene", std::move(wish));
}

// The request's body is a PLY or NRRD file. It is held in memory until the scene is made of it.
asio::awaitable<bool> HttpConnection::showCloud(RequestParser& parser, std::string_view query,
                                                Authorization authorization) {
    const HttpRequest& request = parser.get();
    auto wished = readCloudQuery(query);
    if (const auto* wrong = std::get_if<std::string>(&wished))
        co_return co_await send(request, "cloud", lineReply(400, *wrong));
    SceneWish wish = std::get<SceneWish>(std::move(wished));
    if (request[http::field::content_type].starts_with("multipart/"))
        co_return co_await send(
            request, "cloud", lineReply(415, "this is a form: send the file's bytes alone (curl --data-binary @FILE)"));
    const auto [place, full] = context_->uploads.take(ownerOf(authorization, slot_->network()), kMostUploads);
    if (!place) co_return co_await sendLater(request, "cloud", full);
    if (http::token_list(request[http::field::expect]).exists("100-continue")) {
        constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";
        const auto [refused, size] = co_await asio::async_write(stream_, asio::buffer(kGoOn), kToken);
        if (refused) co_return false;
    }
    const HttpRequest head = request;
    http::request_parser<http::string_body> whole(std::move(parser));
    const auto begun = Clock::now();
    for (size_t bytes = 0; !whole.is_done();) {
        stream_.tcp().expires_after(kPaceGrace);
        const auto [error, size] = co_await http::async_read_some(stream_, buffer_, whole, kToken);
        if (error == http::error::body_limit) co_return co_await send(head, "cloud", tooLarge(context_->options));
        if (error) co_return false; // the connection broke, or nothing came
        bytes += size;
        const auto took = Clock::now() - begun;
        const double due = std::chrono::duration<double>(took - kPaceGrace).count() * kLeastPace;
        if (took > kUploadWithin || double(bytes) < due)
            co_return co_await send(head, "cloud", lineReply(408, "the file came too slowly"));
    }
    unread_ = false;
    if (whole.get().body().empty())
        co_return co_await send(head, "cloud", lineReply(400, "the body is empty: send a PLY or NRRD file"));
    wish.upload = std::move(whole.get().body());
    co_return co_await change(head, "cloud", std::move(wish));
}

// Answers once the scene is shown, or with the reason why the old one stays.
asio::awaitable<bool> HttpConnection::change(const HttpRequest& request, std::string_view route, SceneWish scene) {
    if (room_->audience.replay())
        co_return co_await send(request, route, lineReply(409, "this is a replay: it shows the recorded scene alone"));
    const auto wish = std::make_shared<SceneRequest>(std::move(scene), event_->notifier());
    if (!room_->audience.sceneRequests().push(wish))
        co_return co_await sendLater(request, route, "other scenes are being loaded");
    const auto deadline = Clock::now() + kLoadWithin;
    while (!wish->answered() && Clock::now() < deadline && !context_->stopping) co_await event_->wait(deadline);
    if (!wish->answered() && !context_->stopping) // who sent a cloud need not send it again
        co_return co_await send(request, route,
                                lineReply(202, "it takes long to load, and is shown once it is loaded"));
    if (!wish->answered()) co_return co_await sendLater(request, route, "the server stops");
    const SceneAnswer& answer = wish->answer();
    if (!answer.complaint.empty()) co_return co_await send(request, route, lineReply(422, answer.complaint));
    const std::shared_ptr<const SceneReport> report = room_->audience.report();
    const std::string name = room_->audience.scene()->scene.name;
    Reply reply = lineReply(200, plainText(name, answer));
    if (wantsJson(request)) reply.content_type = "application/json", reply.body = jsonText(name, answer);
    reply.headers = {{"Brume-Tick", fmt::format("{}", report->tick)},
                     {"Brume-State", fmt::format("{:016x}", report->state_hash)},
                     {"Cache-Control", "no-store"}};
    co_return co_await send(request, route, std::move(reply));
}

// The particles of a tick, as a file.
asio::awaitable<bool> HttpConnection::particles(const HttpRequest& request) {
    const auto wish = std::make_shared<ParticleRequest>(event_->notifier());
    if (!room_->audience.particleRequests().push(wish))
        co_return co_await sendLater(request, "particles", "others wait for the particles");
    const auto deadline = Clock::now() + kParticlesWithin;
    while (!wish->answered() && Clock::now() < deadline && !context_->stopping) co_await event_->wait(deadline);
    if (!wish->answered()) co_return co_await sendLater(request, "particles", "no tick comes");
    const TakenParticles& taken = wish->taken();
    if (taken.particles.empty())
        co_return co_await send(request, "particles", lineReply(404, "the scene has no particles now"));
    Reply reply;
    reply.content_type = "application/octet-stream";
    reply.body = particlesPly(taken);
    const std::string name = fmt::format("{}-{:06}.ply", isFileName(taken.scene) ? taken.scene : "scene", taken.tick);
    reply.headers = {{"Brume-Tick", fmt::format("{}", taken.tick)},
                     {"Brume-State", fmt::format("{:016x}", taken.state_hash)},
                     {"Cache-Control", "no-store"},
                     {"Content-Disposition", fmt::format("attachment; filename=\"{}\"", name)}};
    co_return co_await send(request, "particles", std::move(reply));
}

// The scene as it is now, as a file. The query may give it another camera, as of a picture.
Reply HttpConnection::sceneFile(std::string_view query) const {
    const std::shared_ptr<const SceneFacts> facts = room_->audience.scene();
    Scene scene = tuned(*facts, *room_->audience.report());
    const auto picture = readPictureQuery(query, context_->options, scene.camera);
    if (const auto* wrong = std::get_if<std::string>(&picture)) return lineReply(400, *wrong);
    scene.camera = std::get<PictureQuery>(picture).camera;
    const auto fields = parseQuery(query); // which has been read once
    if (const auto given = fields->find("path"); given != fields->end()) {
        auto path = readPathQuery(given->second);
        if (const auto* wrong = std::get_if<std::string>(&path)) return lineReply(400, *wrong);
        scene.camera_keys = std::get<std::vector<CameraKey>>(std::move(path));
    }
    Reply reply;
    reply.content_type = "application/toml";
    reply.body = sceneToml(scene);
    const std::string file = isFileName(scene.name) ? scene.name : "scene";
    reply.headers = {{"Cache-Control", "no-store"},
                     {"Content-Disposition", fmt::format("attachment; filename=\"{}.toml\"", file)}};
    return reply;
}

} // namespace brume::net
