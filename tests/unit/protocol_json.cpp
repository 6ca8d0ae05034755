#include "tests/unit/protocol_json.h"

namespace brume::wire {

using namespace json;

namespace {

Json hex(std::span<const uint8_t> bytes) {
    std::string out;
    for (const uint8_t byte : bytes) {
        out += "0123456789abcdef"[byte >> 4];
        out += "0123456789abcdef"[byte & 15];
    }
    return out;
}

// Left out where there are none: examples that are released keep their words.
template <class Table>
void addFrusta(const Table& m, Json& out) {
    if (m.frustum()) out["frustum"] = frustum(*m.frustum());
    if (m.right_frustum()) out["right_frustum"] = frustum(*m.right_frustum());
}

Json of(const Hello& m) {
    Json out = Json::object({{"client", text(m.client())},
                             {"width", m.width()},
                             {"height", m.height()},
                             {"views", m.views()},
                             {"quality", m.quality()}});
    if (m.lossless()) out["lossless"] = true; // younger than the first examples
    if (m.draw_hz() > 0) out["draw_hz"] = m.draw_hz();
    return out;
}

Json of(const Pose& m) {
    Json out = Json::object({{"seq", m.seq()},
                             {"client_time_us", number(m.client_time_us())},
                             {"position", vec(m.position())},
                             {"orientation", quat(m.orientation())},
                             {"fov_y", m.fov_y()},
                             {"eye_separation", m.eye_separation()},
                             {"width", m.width()},
                             {"height", m.height()}});
    addFrusta(m, out);
    if (m.hidden()) out["hidden"] = true; // younger than the first examples
    if (m.view()) out["view"] = m.view()->str();
    return out;
}

Json of(const Input& m) { return ofInput(m); }
Json of(const Ack& m) { return Json::object({{"frame", m.frame()}}); }
Json of(const Ping& m) { return Json::object({{"nonce", m.nonce()}, {"time_us", number(m.time_us())}}); }
Json of(const Pong& m) { return Json::object({{"nonce", m.nonce()}, {"time_us", number(m.time_us())}}); }
Json of(const Goodbye& m) {
    Json out = Json::object({{"reason", text(m.reason())}, {"retry_after_s", m.retry_after_s()}});
    if (m.go_to()) out["go_to"] = text(m.go_to()); // younger than the first examples
    return out;
}

Json values(const flatbuffers::Vector<flatbuffers::Offset<Value>>& all) {
    Json out = Json::array();
    for (const Value* value : all)
        out.push_back(
            {{"number", maybe(value->number())}, {"vector", vec(value->vector())}, {"text", text(value->text())}});
    return out;
}

// Without the underscore that keeps C++'s keyword apart.
std::string nameOf(Role role) { return role == Role::operator_ ? "operator" : EnumNameRole(role); }

Json settingsOf(const flatbuffers::Vector<flatbuffers::Offset<Setting>>* all) {
    if (!all) return nullptr;
    Json out = Json::array();
    for (const Setting* s : *all) {
        out.push_back({{"path", text(s->path())},
                       {"kind", EnumNameSettingKind(s->kind())},
                       {"unit", text(s->unit())},
                       {"help", text(s->help())},
                       {"least_role", nameOf(s->least_role())},
                       {"lowest", s->lowest()},
                       {"highest", s->highest()},
                       {"usual_lowest", s->usual_lowest()},
                       {"usual_highest", s->usual_highest()},
                       {"choices", names(s->choices())}});
        if (s->only_type()) out.back()["only_type"] = text(s->only_type());
    }
    return out;
}

Json of(const Welcome& m) {
    Json out = Json::object({{"viewer", m.viewer()},
                             {"server", text(m.server())},
                             {"scene", text(m.scene())},
                             {"device", text(m.device())},
                             {"width", m.width()},
                             {"height", m.height()},
                             {"views", m.views()},
                             {"tick_hz", m.tick_hz()},
                             {"max_in_flight", m.max_in_flight()},
                             {"camera",
                              {{"position", vec(m.camera()->position())},
                               {"target", vec(m.camera()->target())},
                               {"fov_y", m.camera()->fov_y()}}},
                             {"methods", names(m.methods())},
                             {"quadratures", names(m.quadratures())}});
    if (m.settings()) out["settings"] = settingsOf(m.settings()); // later than the first examples
    if (m.starts()) out["starts"] = values(*m.starts());
    if (m.scenes()) out["scenes"] = names(m.scenes());
    if (m.medium()) out["medium"] = m.medium()->str();
    if (m.path()) {
        out["path"] = Json::array();
        for (const CameraKey* key : *m.path())
            out["path"].push_back(Json::object({{"position", vec(&key->position())},
                                                {"target", vec(&key->target())},
                                                {"fov_y", key->fov_y()},
                                                {"seconds", key->seconds()}}));
    }
    if (m.lists()) {
        out["lists"] = Json::array();
        for (const List* list : *m.lists())
            out["lists"].push_back(
                {{"name", text(list->name())}, {"most", list->most()}, {"settings", settingsOf(list->settings())}});
    }
    return out;
}

Json of(const SceneState& m) {
    Json passes = Json::array();
    if (m.passes())
        for (const auto* pass : *m.passes()) passes.push_back({{"name", text(pass->name())}, {"ms", pass->ms()}});
    Json out = Json::object({{"tick", number(m.tick())},
                             {"state_hash", number(m.state_hash())},
                             {"viewers", m.viewers()},
                             {"particles", m.particles()},
                             {"paused", m.paused()},
                             {"to_light", vec(m.to_light())},
                             {"irradiance", vec(m.irradiance())},
                             {"rotate", m.rotate()},
                             {"extinction", m.extinction()},
                             {"falloff", m.falloff()},
                             {"anisotropy", m.anisotropy()},
                             {"asymmetry", m.asymmetry()},
                             {"albedo", vec(m.albedo())},
                             {"method", text(m.method())},
                             {"quadrature", text(m.quadrature())},
                             {"steps", m.steps()},
                             {"exposure", m.exposure()},
                             {"passes", std::move(passes)}});
    if (const Plan* plan = m.plan()) // later than the first examples
        out["plan"] = {{"method", text(plan->method())}, {"quadrature", text(plan->quadrature())},
                       {"rate", plan->rate()},           {"slabs", plan->slabs()},
                       {"error", plan->error()},         {"ms", plan->ms()},
                       {"relaxed", plan->relaxed()}};
    if (m.plan() && m.plan()->text()) out["plan"]["text"] = text(m.plan()->text());
    if (m.plan() && m.plan()->promised() > 0) out["plan"]["promised"] = m.plan()->promised();
    if (m.settings()) out["settings"] = values(*m.settings());
    if (m.undo()) out["undo"] = m.undo()->str();
    if (m.lo()) out["lo"] = vec(m.lo());
    if (m.hi()) out["hi"] = vec(m.hi());
    if (m.lists()) {
        out["lists"] = Json::array();
        for (const Elements* list : *m.lists()) out["lists"].push_back({{"values", floats(list->values())}});
    }
    return out;
}

Json of(const Frame& m) {
    const Stages& s = *m.stages();
    Json lengths = Json::array();
    for (const uint32_t length : *m.jpeg_bytes()) lengths.push_back(length);
    Json out = {
        {"id", m.id()},
        {"tick", number(m.tick())},
        {"state_hash", number(m.state_hash())},
        {"pose_seq", m.pose_seq()},
        {"client_time_us", number(m.client_time_us())},
        {"position", vec(m.position())},
        {"orientation", quat(m.orientation())},
        {"fov_y", m.fov_y()},
        {"width", m.width()},
        {"height", m.height()},
        {"quality", m.quality()},
        {"stages",
         {{"wait", s.wait()}, {"render", s.render()}, {"encode", s.encode()}, {"queue", s.queue()}, {"gpu", s.gpu()}}},
        {"jpeg_bytes", std::move(lengths)}};
    addFrusta(m, out);
    if (m.encoding() != Encoding::jpeg) out["encoding"] = EnumNameEncoding(m.encoding());
    if (m.measured() > 0) { // younger than the first examples
        out["measured"] = m.measured();
        out["measured_low"] = m.measured_low();
        out["measured_high"] = m.measured_high();
    }
    return out;
}

Json of(const Presence& m) {
    Json out = Json::object({{"name", text(m.name())}, {"follow", m.follow()}, {"cameras", m.cameras()}});
    if (const Ray* ray = m.pointer())
        out["pointer"] = {{"origin", vec(&ray->origin())}, {"direction", vec(&ray->direction())}};
    return out;
}

Json of(const Lead& m) { return Json::object({{"person", m.person()}}); }

Json of(const People& m) {
    Json people = Json::array();
    for (const Person* one : *m.people()) {
        Json person = Json::object({{"id", one->id()},
                                    {"name", text(one->name())},
                                    {"known", one->known()},
                                    {"colour", one->colour()},
                                    {"role", EnumNameRole(one->role())},
                                    {"follows", one->follows()}});
        if (const Look* look = one->look())
            person["look"] = {{"position", vec(&look->position())},
                              {"orientation", quat(&look->orientation())},
                              {"right", look->right()},
                              {"up", look->up()}};
        if (one->pointer()) person["pointer"] = vec(one->pointer());
        people.push_back(std::move(person));
    }
    return Json::object({{"people", std::move(people)}, {"count", m.count()}, {"presenter", m.presenter()}});
}

Json of(const LitParticles& m) {
    Json hues = Json::array(), objects = Json::array();
    for (const Hue* hue : *m.hues()) hues.push_back({{"channels", hue->channels()}, {"extinction", hue->extinction()}});
    if (m.objects())
        for (const Object* o : *m.objects())
            objects.push_back({{"kind", EnumNameObjectKind(o->kind())},
                               {"centre", vec(&o->centre())},
                               {"half_size", vec(&o->half_size())},
                               {"yaw", o->yaw()},
                               {"albedo", vec(&o->albedo())}});
    Json out = Json::object({{"id", m.id()},
                             {"tick", number(m.tick())},
                             {"state_hash", number(m.state_hash())},
                             {"number", m.number()},
                             {"reference", m.reference()},
                             {"first", number(m.first())},
                             {"count", m.count()},
                             {"present", number(m.present())},
                             {"origin", vec(m.origin())},
                             {"step", m.step()},
                             {"falloff", m.falloff()},
                             {"to_light", vec(m.to_light())},
                             {"irradiance", vec(m.irradiance())},
                             {"phase", floats(m.phase())},
                             {"ambient", vec(m.ambient())},
                             {"hues", std::move(hues)},
                             {"straight", vec(m.straight())},
                             {"mean_cosine", m.mean_cosine()},
                             {"zenith", vec(m.zenith())},
                             {"horizon", vec(m.horizon())},
                             {"haze", m.haze()},
                             {"exposure", m.exposure()},
                             {"filmic", m.filmic()},
                             {"objects", std::move(objects)},
                             {"predicted", m.predicted()},
                             {"measured", m.measured()},
                             {"measured_low", m.measured_low()},
                             {"measured_high", m.measured_high()},
                             {"bytes", m.bytes()},
                             {"age_ms", m.age_ms()}});
    if (m.emission()) out["emission"] = vec(m.emission()); // later than the first examples
    if (m.cold_albedo()) out["cold_albedo"] = vec(m.cold_albedo());
    return out;
}

Json of(const Error& m) {
    return Json::object(
        {{"code", EnumNameErrorCode(m.code())}, {"text", text(m.text())}, {"input_seq", m.input_seq()}});
}

} // namespace

Json describe(const Parsed& message) {
    Json body = Json::object();
    Json out = Json::object({{"type", EnumNameBody(message.type())}});
    switch (message.type()) {
    case Body::Hello:
        body = of(*message.as<Hello>());
        break;
    case Body::Pose:
        body = of(*message.as<Pose>());
        break;
    case Body::Input:
        body = of(*message.as<Input>());
        break;
    case Body::Ack:
        body = of(*message.as<Ack>());
        break;
    case Body::Ping:
        body = of(*message.as<Ping>());
        break;
    case Body::Pong:
        body = of(*message.as<Pong>());
        break;
    case Body::Goodbye:
        body = of(*message.as<Goodbye>());
        break;
    case Body::Welcome:
        body = of(*message.as<Welcome>());
        break;
    case Body::SceneState:
        body = of(*message.as<SceneState>());
        break;
    case Body::Frame:
        body = of(*message.as<Frame>());
        break;
    case Body::Error:
        body = of(*message.as<Error>());
        break;
    case Body::LitParticles:
        body = of(*message.as<LitParticles>());
        break;
    case Body::Presence:
        body = of(*message.as<Presence>());
        break;
    case Body::Lead:
        body = of(*message.as<Lead>());
        break;
    case Body::People:
        body = of(*message.as<People>());
        break;
    case Body::NONE:
        break;
    }
    out["body"] = std::move(body);
    if (const Frame* frame = message.as<Frame>()) {
        Json views = Json::array();
        for (uint32_t view = 0; view < frame->jpeg_bytes()->size(); ++view) views.push_back(hex(message.view(view)));
        out["jpeg"] = std::move(views);
    }
    if (message.as<LitParticles>()) out["columns"] = hex(message.jpeg);
    return out;
}

} // namespace brume::wire
