// A server that scenes are switched on, and a folder for its files.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"

namespace brume::test {

namespace fs = std::filesystem;

// A cloud of a few thick points about (3, 0, 0).
inline std::string points(const std::string& first_x = "2") {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "property float scale\nproperty float sigma_t\nend_header\n" +
           first_x + " 0 0 4 30\n3 1 0 4 30\n4 0 0 4 30\n";
}

inline std::string postHead(const std::string& target, size_t length) {
    return "POST " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: " + std::to_string(length) + "\r\n";
}

inline HttpReply post(uint16_t port, const std::string& target, const std::string& body = "") {
    HttpConnection connection(port);
    connection.send(postHead(target, body.size()) + "\r\n" + body);
    return connection.readReply();
}

class Scenes : public testing::Test {
protected:
    const fs::path folder_ = fs::path(testing::TempDir()) / ("brume-scenes-" + std::to_string(getpid()));
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    std::string clouds() const { return (folder_ / "clouds").string(); }
    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc) << text;
        return folder_ / name;
    }
};

} // namespace brume::test
