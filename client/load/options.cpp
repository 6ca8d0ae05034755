#include "client/load/options.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <CLI/CLI.hpp>
#include <wordexp.h>

#include "common/option_range.h"
#include "protocol/net/address.h"

namespace brume::load {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& why) {
    throw CLI::ValidationError(option, "'" + text + "' " + why);
}

Path pathNamed(const std::string& name) {
    if (name == "stereo") return {client::PathKind::orbit, true};
    const auto kind = client::pathNamed(name);
    if (!kind || kind == client::PathKind::keys)
        refuse("--paths", name, "is not one of orbit, fly, walk, still, stereo, or several of them: orbit,fly");
    return {*kind, false};
}

// Words as a shell would make them of it, without running anything.
std::vector<std::string> wordsOf(const std::string& text) {
    wordexp_t words{};
    if (wordexp(text.c_str(), &words, WRDE_NOCMD | WRDE_UNDEF) != 0)
        refuse("--start", text, "cannot be split into words: quotes in pairs, nothing that a shell would run");
    std::vector<std::string> all(words.we_wordv, words.we_wordv + words.we_wordc);
    wordfree(&words);
    return all;
}

} // namespace

std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code) {
    Options options;
    std::vector<std::string> paths{"orbit"}, budgets, servers;
    std::string start = "--scene cloud", out, token_file, ca;

    CLI::App app("Watches brume servers as many viewers at once, and measures what each gets and what they cost.",
                 "brume-load");
    app.set_version_flag("--version", "brume-load " BRUME_VERSION);
    allow(app.add_option("--viewers", options.viewers, "Numbers of viewers, one run each")
              ->delimiter(',')
              ->allow_extra_args(false)
              ->default_str("1,2,4,8,16,32"),
          1u, kMostViewers);
    allow(app.add_option("--seconds", options.seconds, "Length of each run")->capture_default_str(), 0.5, 3600.0);
    allow(app.add_option("--warm-up", options.warm_up,
                         "Seconds before each run that are not measured; every viewer has frames by then")
              ->capture_default_str(),
          0.0, 600.0);
    app.add_option("--paths", paths,
                   "Where viewers go, in turn: orbit, fly, walk (around the scene's own camera), still, "
                   "stereo (orbit with two eyes)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->default_str("orbit");
    allow(app.add_option("--width", options.wishes.width, "Pixels of one eye")->capture_default_str(), 16, 8192);
    allow(app.add_option("--height", options.wishes.height)->capture_default_str(), 16, 8192);
    allow(app.add_option("--quality", options.wishes.quality, "JPEG quality wished for, 1 to 100; 0 = the server's"), 0,
          100);
    auto* const follow = app.add_flag("--follow", options.follow,
                                      "All follow the first viewer's camera, as a class does who presents: equal "
                                      "pictures are drawn once");
    app.add_flag("--fixed-size", options.wishes.keep_size,
                 "Pictures come more seldom, not smaller, however busy the server is: for comparisons");
    allow(app.add_option(
              "--layers", options.layers,
              "Layers with depth that every viewer asks for, in pictures a tenth wider and higher, as pages do"),
          0, 8);
    allow(app.add_option("--draw", options.wishes.draw_hz,
                         "Viewers draw by themselves: they take so many lit particles a second in place of pictures"),
          0, 60)
        ->excludes(follow);
    app.add_flag("--decode", options.decode,
                 "Decode the pictures too, or unpack the particles, as a real viewer does; costs CPU time here");
    allow(app.add_option("--push", options.push, "Pushes a second of each viewer, near the middle of the scene")
              ->capture_default_str(),
          0.0, 1000.0);
    app.add_option("--seed", options.seed, "Seed of those pushes: the same one pushes the same way")
        ->capture_default_str()
        ->type_name("NUMBER")
        ->check(CLI::Validator(CLI::NonNegativeNumber).description(""));
    auto* const running =
        app.add_option("--server", servers,
                       "A server that runs already: ws://127.0.0.1:8080; or several servers of one shared simulation, "
                       "with commas: viewers are spread over them in turn, and their ticks must be equal")
            ->delimiter(',')
            ->allow_extra_args(false);
    app.add_option("--token-file", token_file, "File with an operator's token for that server; without it BRUME_TOKEN")
        ->needs(running);
    app.add_option("--ca", ca, "PEM file of who vouches for a wss:// server, instead of whom the system trusts")
        ->needs(running);
    app.add_flag("--reconnect", options.reconnect,
                 "Viewers that lose a server come back: at once where its goodbye sends them, or to the next of "
                 "--server; when all have failed, they try four times a second")
        ->needs(running);
    app.add_flag("--anywhere", options.anywhere, "Let --server be another machine");
    app.add_option("--start", start,
                   "Arguments of the server that is started, on a free port, when --server is not given")
        ->capture_default_str()
        ->excludes(running);
    allow(app.add_option("--timeout", options.timeout, "Give up when a viewer gets no frame for so many seconds")
              ->capture_default_str(),
          0.1, 3600.0);
    app.add_option("--out", out, "Write load.json, load.md and load.svg to this folder");
    app.add_option("--assert", budgets, "Fail unless this holds: fps>=15@16, p95<=200, command_p95<=50; repeatable")
        ->allow_extra_args(false);

    try {
        app.parse(argc, argv);
        for (const double seconds : {options.seconds, options.warm_up, options.timeout})
            if (!std::isfinite(seconds)) throw CLI::ValidationError("a time", "is a number of seconds");
        if (!std::isfinite(options.push)) throw CLI::ValidationError("--push", "is a number of pushes a second");
        options.paths.clear();
        for (const auto& name : paths) options.paths.push_back(pathNamed(name));
        for (const auto& text : budgets) {
            try {
                options.budgets.push_back(parseBudget(text));
            } catch (const std::invalid_argument& error) {
                throw CLI::ValidationError("--assert", error.what());
            }
            const auto& viewers = options.budgets.back().viewers;
            if (viewers && std::find(options.viewers.begin(), options.viewers.end(), *viewers) == options.viewers.end())
                refuse("--assert", text, "is about a number of viewers that --viewers does not have");
        }
        for (const std::string& url : servers) {
            client::Endpoint server = client::parseUrl(url);
            server.token = client::readToken(token_file);
            server.ca = ca;
            if (!options.anywhere && !isLoopback(server.host))
                refuse("--server", url, "is not this machine; say --anywhere if you may load it");
            for (const client::Endpoint& other : options.servers)
                if (other.url() == server.url()) refuse("--server", url, "is named twice");
            options.servers.push_back(std::move(server));
        }
        if (options.follow && options.servers.size() > 1)
            throw CLI::ValidationError("--follow", "is for one server: people of several do not see each other");
        options.server_arguments = wordsOf(start);
        options.out = out;
    } catch (const CLI::Success& success) { // --help, --version
        exit_code = app.exit(success);
        return {};
    } catch (const std::exception& error) {
        std::cerr << "brume-load: " << error.what() << "; --help lists what there is\n";
        exit_code = 2;
        return {};
    }
    return options;
}

} // namespace brume::load
