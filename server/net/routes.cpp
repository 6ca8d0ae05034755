#include "server/net/routes.h"

#include <algorithm>

#include "server/net/rooms.h"

namespace brume::net {
namespace {

constexpr std::string_view kRead = "GET, HEAD", kGet = "GET", kPost = "POST";
constexpr Route kRoutes[] = {
    {"/", kRead, {}},
    {"/ws", kRead, Role::viewer},
    {"/healthz", kRead, {}},
    {"/readyz", kRead, {}},
    {"/metrics", kRead, Role::operator_},
    {"/viewers", kRead, Role::operator_},
    {"/snapshot.jpg", kGet, Role::viewer},
    {"/snapshot.png", kGet, Role::viewer},
    {"/snapshot.exr", kGet, Role::viewer},
    {"/stream.mjpg", kGet, Role::viewer},
    {"/pause", kPost, Role::controller},
    {"/resume", kPost, Role::controller},
    {"/seek", kPost, Role::controller},
    {"/scene", kPost, Role::operator_},
    {"/scene.toml", kRead, Role::viewer},
    {"/particles.ply", kGet, Role::operator_},
    {"/cloud", kPost, Role::operator_, true},
    {"/rooms", kRead, Role::viewer, false, true},
    {"/rooms/open", kPost, Role::operator_, false, true},
    {"/rooms/close", kPost, Role::operator_, false, true},
};

} // namespace

bool Route::takes(std::string_view method) const {
    return method == methods || (methods == kRead && (method == "GET" || method == "HEAD"));
}

std::span<const Route> allRoutes() { return kRoutes; }

const Route* routeOf(std::string_view path) {
    const RoomPath in = roomPathOf(path);
    const auto found = std::ranges::find(kRoutes, in.path, &Route::path);
    if (found == std::end(kRoutes) || (found->of_server && !in.room.empty())) return nullptr;
    return &*found;
}

} // namespace brume::net
