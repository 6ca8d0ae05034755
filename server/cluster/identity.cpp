#include "server/cluster/identity.h"

#include <fmt/format.h>

#include "common/text.h"
#include "server/operate/recording.h"
#include "server/sim/state_hash.h"

namespace brume::cluster {
namespace {

constexpr int kRules = 1; // of Log and of a state's bytes: another number is another version

// The bytes of a state have settings in the order of the table.
uint64_t hashOfTable() {
    StateHash hash;
    for (const SceneSetting& setting : sceneSettings()) hash.add(setting.path);
    return hash.value();
}

std::string versionAndScene(const Identity& identity) {
    return fmt::format("brume {} scene {} ", identity.version, identity.scene);
}

} // namespace

Identity identityOf(const Simulation& simulation, const std::string& scene, const std::string& text,
                    const std::vector<std::string>& overrides) {
    StateHash hash;
    hash.add(std::string_view(text));
    for (const std::string& one : overrides) hash.add(std::string_view(one));
    hash.add(simulation.origin());
    return {fmt::format("{}/{}.{}.{:08x}", BRUME_VERSION, kRecordingVersion, kRules, uint32_t(hashOfTable())), scene,
            hash.value()};
}

std::string textOf(const Identity& identity) { return versionAndScene(identity) + hexOf(identity.hash); }

std::string differenceOf(const Identity& own, const std::string& description) {
    if (description == textOf(own)) return {};
    if (description.starts_with(versionAndScene(own)))
        return fmt::format("scene '{}' with another file, other particles or other --set", own.scene);
    if (description.starts_with("brume " + own.version + " "))
        return fmt::format("another scene ({}), while this server shows '{}'", oneLine(description), own.scene);
    return fmt::format("another version ({}), while this server is brume {}", oneLine(description), own.version);
}

} // namespace brume::cluster
