#include "server/options/options.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/nearest.h"
#include "common/plain_file.h"
#include "common/settings.h"
#include "common/settings_tables.h"
#include "common/text.h"
#include "server/cluster/trust.h"
#include "server/operate/config_file.h"
#include "server/options/groups.h"
#include "server/plan/plan.h"
#include "server/sim/point_cloud.h"

namespace brume {
namespace {

// The first of the places where a folder of ours may be: installed beside the program, in the source tree, here.
std::filesystem::path findFolder(const char* installed, const char* in_source) {
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    for (const auto& folder :
         {program / "../share/brume" / installed, program / "../../.." / in_source, std::filesystem::path(in_source)})
        if (std::filesystem::is_directory(folder, error)) return std::filesystem::canonical(folder, error);
    return in_source;
}

// --config FILE, or BRUME_CONFIG. Returns what reads the file.
std::shared_ptr<ConfigFile> addConfigFile(CLI::App& app) {
    const char* from_environment = std::getenv("BRUME_CONFIG");
    const std::string file = from_environment ? from_environment : "";
    app.set_config("--config", file, "TOML file with any of these options as keys: max-viewers = 8", !file.empty())
        ->type_name("FILE");
    const auto complaint = [](const std::string& name) { return isNoPlainFile(name) ? name + ": is not a file" : ""; };
    app.get_config_ptr()->check(CLI::Validator(complaint, "", "config"));
    auto reader = std::make_shared<ConfigFile>(app);
    app.config_formatter(reader);
    return reader;
}

// All options as they stand.
std::vector<Setting> settingsOf(const OptionTable& table) {
    std::vector<Setting> settings;
    for (const CLI::Option* option :
         table.app.get_options([](const CLI::Option* one) { return one->get_configurable(); }))
        settings.push_back({option->get_single_name(), tomlOf(*option), table.live.contains(option)});
    return settings;
}

// The first group of --help: --help itself and the options that most people need.
void leadWith(CLI::App& app, std::initializer_list<const char*> names) {
    constexpr const char* kGroup = "Most used";
    app.get_help_ptr()->group(kGroup);
    for (const char* name : names) app.get_option(name)->group(kGroup);
}

// Options that do not go together: what is wrong, or empty.
std::string mistakeIn(const ServerOptions& o) {
    if (o.look && o.replay.empty()) return "--look: nothing to look at; allowed: with --replay FILE";
    if (!o.rooms.empty() && !o.replay.empty())
        return "--room and --replay exclude each other: a replay shows the recorded scene alone";
    if (!o.cluster.engine.servers.empty() && !o.replay.empty())
        return "--cluster and --replay exclude each other: a replay has a clock of its own";
    if (o.cluster.engine.certificate.empty() != o.cluster.engine.key.empty())
        return "--cluster-certificate and --cluster-key belong together: give both, or neither";
    if (const std::string open = cluster::openServer(o.cluster.engine); !open.empty())
        return fmt::format("--cluster {}: whoever reaches it could write the cloud; give a user and a password in the "
                           "URL, or --cluster-credentials or --cluster-certificate",
                           open);
    if (!o.out.empty() && o.replay.empty()) return "--out: nothing to make a film of; allowed: with --replay FILE";
    if (o.look && !o.out.empty()) return "--look and --out exclude each other: look at a replay, or make a film of it";
    return "";
}

// What is wrong with the first option on the command line that there is none of; nothing if all that was too much are
// plain words.
std::optional<std::string> strangerIn(const CLI::App& app) {
    const std::vector<std::string> left = app.remaining();
    const auto found = std::find_if(left.begin(), left.end(), [](const auto& word) { return word.starts_with("-"); });
    if (found == left.end()) return {};
    const std::string name = found->substr(0, found->find('='));
    std::string key = name.substr(std::min(name.find_first_not_of('-'), name.size()));
    std::ranges::replace(key, '-', '_');
    const auto settings = sceneSettings();
    if (const auto one = std::ranges::find(settings, key, &SceneSetting::key); one != settings.end())
        return fmt::format("{}: no such option; did you mean --set {}=VALUE?", oneLine(name), one->path);
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options({})) names.push_back("--" + option->get_single_name());
    return oneLine(name) + ": no such option" + didYouMean(name, names);
}

// The command line ends here, well if that was printed.
ParsedOptions printed(const std::string& text) {
    std::cout << text << std::flush;
    return {std::nullopt, std::cout ? 0 : 1, {}, {}};
}

} // namespace

ParsedOptions parseServerOptions(int argc, const char* const* argv) {
    ServerOptions o;
    o.scene_dir = findFolder("scenes", "server/scenes");
    o.net.web_root = findFolder("web", "client/web/dist");
    o.costs = userCacheFolder();
    o.cloud_dir = o.costs / "clouds";
    CLI::App app{"brume-server: simulates one cloud, lights it once and renders it for every viewer."};
    app.set_version_flag("--version", "brume-server " BRUME_VERSION);
    app.option_defaults()->always_capture_default()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    const std::shared_ptr<ConfigFile> file = addConfigFile(app);

    OptionTable table{app};
    bool print_config = false;
    OptionGroup(table, nullptr)
        .flag("--print-config", print_config, "print all options as they stand as such a file, and end")
        .flagOnly();
    bool print_settings = false;
    OptionGroup(table, nullptr)
        .flag("--print-settings", print_settings,
              "print all settings of a scene as tables, those of docs/scenes.md, and end")
        .flagOnly();
    TokenRequest token;
    addTokenOptions(table, token);
    addSceneOptions(table, o);
    addNetworkOptions(table, o);
    addTrustOptions(table, o);
    addLimitOptions(table, o);
    addStopOptions(table, o);
    addDeviceOptions(table, o);
    addLogOptions(table, o);
    addRecordOptions(table, o);
    addClusterOptions(table, o);
    leadWith(app, {"--scene", "--set", "--method", "--listen", "--port"});

    try {
        app.parse(argc, argv);
        takeEnvironment(app);
    } catch (const CLI::Success& e) {
        showEnvironment(app);
        return {std::nullopt, app.exit(e), {}, {}};
    } catch (const CLI::ExtrasError& e) {
        return {std::nullopt, 2, strangerIn(app).value_or(e.what()), {}};
    } catch (const CLI::ParseError& e) {
        std::string complaint = file->sourceOf(e.what()) + e.what();
        std::replace(complaint.begin(), complaint.end(), '\n', ' ');
        return {std::nullopt, 2, std::move(complaint), {}};
    }
    for (const auto& act : table.afterwards) act();
    if (std::string mistake = mistakeIn(o); !mistake.empty()) return {std::nullopt, 2, std::move(mistake), {}};
    if (print_settings) return printed(settingsTables());
    if (print_config) return printed(writeConfig(app));
    try {
        if ((o.replay.empty() || o.look) && !o.explain) readTrust(o);
        if (!token.role.empty()) return printed(makeToken(token, o.net.token_key) + "\n");
    } catch (const std::exception& e) {
        return {std::nullopt, 2, e.what(), {}};
    }
    return {std::move(o), 0, {}, settingsOf(table)};
}

std::vector<std::string> sceneOverrides(const ServerOptions& o) {
    std::vector<std::string> all = o.overrides;
    const std::vector<std::string> of_renderer = rendererOverrides(o);
    all.insert(all.end(), of_renderer.begin(), of_renderer.end());
    return all;
}

std::vector<std::string> rendererOverrides(const ServerOptions& o) {
    std::vector<std::string> all;
    const auto add = [&](const char* key, const auto& value) {
        if (value) all.push_back(fmt::format("{}={}", key, *value));
    };
    add("render.method", o.method);
    add("simulation.paused", o.paused);
    return all;
}

void checkScene(const Scene& scene, const std::filesystem::path& file, std::span<const std::string> overrides) {
    const std::string wrong = checkWanted(scene.render, file.string(), overrides);
    if (!wrong.empty()) throw SceneError(wrong);
}

Scene loadScene(const ServerOptions& o) {
    const std::filesystem::path file = findScene(o.scene, o.scene_dir);
    const std::vector<std::string> overrides = sceneOverrides(o);
    Scene scene = loadScene(file, overrides);
    checkScene(scene, file, overrides);
    placeCamera(scene);
    return scene;
}

} // namespace brume
