// The built page: files of one folder, nothing else.
#pragma once

#include <filesystem>
#include <string_view>

#include "server/net/reply.h"

namespace brume::net {

class Pages {
public:
    explicit Pages(std::filesystem::path root) : root_(std::move(root)) {}

    // `path` is a request's, still percent-encoded, without its query; "/" is index.html. 404 for whatever is not a plain file
    // below the root, hidden or reached through a link that leads out; 304 when `if_none_match` holds the file's tag.
    Reply serve(std::string_view path, std::string_view if_none_match) const;

private:
    std::filesystem::path root_;
};

} // namespace brume::net
