// Scene files for tests of loading.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "common/scene.h"

namespace brume::test {

inline std::filesystem::path written(const std::string& text, const std::string& name = "scene_test.toml") {
    std::filesystem::path file = std::filesystem::path(testing::TempDir()) / name;
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

// Why a scene of this text is refused.
inline std::string errorOf(const std::string& text) {
    try {
        loadScene(written(text));
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

} // namespace brume::test
