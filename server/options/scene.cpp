#include "server/options/groups.h"

#include "server/net/rooms.h"

namespace brume {
namespace {

std::string checkRoom(const std::string& room) {
    const size_t end = room.find('=');
    const bool good = end != room.npos && net::isRoomName(room.substr(0, end)) && end + 1 < room.size();
    return good ? "" : "allowed: NAME=SCENE, the name of letters, digits, '-' and '_'";
}

} // namespace

void addSceneOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Scene");
    g.option("--scene", o.scene, "name of a scene, or the path of a .toml file").live();
    g.several("--room", o.rooms, '\n', "another scene beside it, at /r/NAME/ with people of its own: --room lab=cloud")
        .unit("NAME=SCENE")
        .standing("")
        .check(checkRoom);
    g.option("--max-rooms", o.max_rooms, "rooms besides the scene at /; operators may open them, too").range(0u, 64u);
    g.option("--idle-rooms", o.idle_rooms, "rooms that nobody looks at: tick goes on, sleep stands still")
        .oneOf({"tick", "sleep"});
    g.option("--scene-dir", o.scene_dir, "folder of the scenes known by name");
    g.option("--cloud-dir", o.cloud_dir, "folder of uploaded point clouds, the newest 16");
    g.several("--set", o.overrides, '\n', "a setting instead of the scene's, as in its file: --set medium.count=5000")
        .unit("KEY=VALUE")
        .standing("")
        .live();
    g.option("--method", o.method, "medium method instead of the scene's; auto: the cheapest within render.error");
    g.flag(
         "--paused", [&o](bool paused) { o.paused = paused; },
         "start with the simulation paused, or not: instead of the scene's")
        .standing("the scene's");
}

} // namespace brume
