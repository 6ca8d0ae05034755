// Serves the built page: the files of one folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/reply.h"

namespace brume::net {

class Pages {
public:
    explicit Pages(std::filesystem::path root) : root_(std::move(root)) {}

    // `path` is a request's, still percent-encoded, without its query; "/" is index.html. 404 for all that is not a
    // plain file below the root, hidden or reached through a link that leads out; 304 when `if_none_match` holds the
    // file's tag. Pages of `framed_by` ("https://clouds.example", "*") may show ours in a frame, besides our own.
    Reply serve(std::string_view path, std::string_view if_none_match,
                const std::vector<std::string>& framed_by = {}) const;

private:
    Reply read(std::string_view path, std::string_view if_none_match) const;

    std::filesystem::path root_;
};

// 404, with the list of the paths that the server answers itself.
Reply noSuchPage();

} // namespace brume::net
