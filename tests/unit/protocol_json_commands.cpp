#include "tests/unit/protocol_json.h"

namespace brume::wire::json {
namespace {

Json of(const Impulse& c) {
    return Json::object({{"origin", vec(c.origin())},
                         {"direction", vec(c.direction())},
                         {"push", vec(c.push())},
                         {"strength", c.strength()}});
}
Json of(const MoveVolume& c) { return Json::object({{"offset", vec(c.offset())}}); }
Json of(const Restart&) { return Json::object(); }
Json changesOf(const flatbuffers::Vector<flatbuffers::Offset<Change>>* all) {
    if (!all) return nullptr;
    Json changes = Json::array();
    for (const Change* change : *all)
        changes.push_back(Json::object({{"path", text(change->path())},
                                        {"number", maybe(change->number())},
                                        {"vector", vec(change->vector())},
                                        {"text", text(change->text())}}));
    return changes;
}
Json of(const Set& c) { return Json::object({{"changes", changesOf(c.changes())}}); }
Json of(const Add& c) { return Json::object({{"list", text(c.list())}, {"changes", changesOf(c.changes())}}); }
Json of(const Remove& c) { return Json::object({{"path", text(c.path())}}); }

Json of(const Undo& c) { return Json::object({{"operators", c.operators()}}); }

Json of(const SetParticles& c) {
    return Json::object({{"first", c.first()},
                         {"positions", floats(c.positions())},
                         {"scales", floats(c.scales())},
                         {"extinctions", floats(c.extinctions())},
                         {"albedos", floats(c.albedos())},
                         {"live", c.live()},
                         {"seconds", c.seconds()}});
}

} // namespace

Json ofInput(const Input& m) {
    Json command = Json::object();
    switch (m.command_type()) {
    case Command::Impulse:
        command = of(*m.command_as_Impulse());
        break;
    case Command::MoveVolume:
        command = of(*m.command_as_MoveVolume());
        break;
    case Command::Restart:
        command = of(*m.command_as_Restart());
        break;
    case Command::Set:
        command = of(*m.command_as_Set());
        break;
    case Command::SetParticles:
        command = of(*m.command_as_SetParticles());
        break;
    case Command::Add:
        command = of(*m.command_as_Add());
        break;
    case Command::Remove:
        command = of(*m.command_as_Remove());
        break;
    case Command::Undo:
        command = of(*m.command_as_Undo());
        break;
    case Command::NONE:
        break;
    }
    return Json::object({{"seq", m.seq()},
                         {"client_time_us", number(m.client_time_us())},
                         {"command_type", EnumNameCommand(m.command_type())},
                         {"command", std::move(command)}});
}

} // namespace brume::wire::json
