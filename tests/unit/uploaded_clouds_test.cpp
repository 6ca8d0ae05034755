// The folder of uploaded clouds, which may hold files of others.
#include "server/operate/uploaded_clouds.h"

#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/scene.h"

namespace brume {
namespace {

namespace fs = std::filesystem;

class UploadedCloudsTest : public testing::Test {
protected:
    const fs::path folder = fs::path(testing::TempDir()) / fmt::format("brume-clouds-{}", getpid());
    const UploadedClouds clouds{folder};
    void TearDown() override { fs::remove_all(folder); }

    void upload(const std::string& name, const std::string& points = "points", int seconds_ago = 0,
                const std::string& ending = ".ply") const {
        const fs::path scene = clouds.take(name, points, ending).keep("# a scene of " + points + "\n");
        fs::last_write_time(scene, fs::file_time_type::clock::now() - std::chrono::seconds(seconds_ago));
    }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories(folder);
        std::ofstream(folder / name) << text;
    }
    std::string read(const std::string& name) const {
        std::ifstream in(folder / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::set<std::string> files() const { // all but the folder of those that come
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder))
            if (!entry.is_directory()) names.insert(entry.path().filename().string());
        return names;
    }
    std::string refusalOf(const std::string& name) const {
        try {
            upload(name);
        } catch (const SceneError& error) {
            return error.what();
        }
        return "";
    }
};

TEST_F(UploadedCloudsTest, OnlyWhatWasUploadedIsRemoved) {
    std::set<std::string> expected;
    for (int i = 0; i < 20; ++i)
        for (const char* kind : {"toml", "ply", "txt"}) {
            const std::string name = fmt::format("others-{}.{}", i, kind);
            write(name, "mine");
            expected.insert(name);
        }
    for (size_t i = 0; i < UploadedClouds::kMost + 3; ++i) {
        upload(fmt::format("cloud-{}", i), "points", 1000 - int(i));
        if (i < 3) continue;
        expected.insert(fmt::format("cloud-{}.toml", i));
        expected.insert(fmt::format("cloud-{}.ply", i));
    }
    EXPECT_EQ(files(), expected);
    EXPECT_TRUE(fs::is_empty(folder / "incoming"));
}

TEST_F(UploadedCloudsTest, WhatSomebodyChangedIsHis) {
    upload("edited", "points", 2000);
    write("edited.toml", read("edited.toml") + "[sky]\n");
    upload("replaced", "points", 2000);
    write("replaced.ply", "other points");
    upload("recoloured", "points", 2000);
    write("recoloured.ply", "POINTS");
    fs::last_write_time(folder / "recoloured.ply", fs::file_time_type::clock::now() + std::chrono::seconds(1));
    write("plain.toml", "");
    write("pipe.ply", "of a scene elsewhere");
    for (size_t i = 0; i < UploadedClouds::kMost + 1; ++i) upload(fmt::format("cloud-{}", i));
    EXPECT_EQ(read("replaced.ply"), "other points");
    EXPECT_NE(read("edited.toml"), "");
    EXPECT_EQ(read("recoloured.ply"), "POINTS");
    for (const char* name : {"edited", "replaced", "recoloured", "plain", "pipe"}) {
        const std::string why = refusalOf(name);
        EXPECT_NE(why.find("?name="), why.npos) << name << ": " << why;
    }
    EXPECT_EQ(read("plain.toml"), "");
}

TEST_F(UploadedCloudsTest, ACloudReplacesItsOwnWhole) {
    upload("mine", "old points");
    upload("mine", "new points");
    EXPECT_EQ(read("mine.ply"), "new points");
    EXPECT_TRUE(read("mine.toml").ends_with("# a scene of new points\n"));
    { const auto dropped = clouds.take("mine", "worse", ".ply"); }
    EXPECT_EQ(read("mine.ply"), "new points");
    EXPECT_TRUE(fs::is_empty(folder / "incoming"));
}

TEST_F(UploadedCloudsTest, AVolumeReplacesPointsAndPointsAVolume) {
    upload("mine", "points");
    upload("mine", "voxels", 0, ".nrrd");
    EXPECT_EQ(files(), (std::set<std::string>{"mine.nrrd", "mine.toml"}));
    upload("mine", "points");
    EXPECT_EQ(files(), (std::set<std::string>{"mine.ply", "mine.toml"}));
    upload("first", "voxels", 100, ".nrrd");
    for (size_t i = 0; i < UploadedClouds::kMost; ++i) upload(fmt::format("cloud-{}", i), "points", 1);
    EXPECT_FALSE(fs::exists(folder / "first.nrrd") || fs::exists(folder / "first.toml"));
    write("other.nrrd", "somebody's");
    EXPECT_NE(refusalOf("other"), "");
}

TEST_F(UploadedCloudsTest, WhatCannotBeWrittenSaysSoAndLeavesNothing) {
    std::ofstream(folder) << "a file, no folder";
    EXPECT_NE(refusalOf("mine").find("--cloud-dir"), std::string::npos);
    fs::remove(folder);
    fs::create_directories(folder);
    write("incoming", "a file, no folder");
    EXPECT_NE(refusalOf("mine").find("--cloud-dir"), std::string::npos);
    EXPECT_EQ(files(), std::set<std::string>{"incoming"});
}

TEST_F(UploadedCloudsTest, WhatLiesWhereUploadsComeStays) {
    fs::create_directories(folder / "incoming");
    write("incoming/mine.ply", "not the server's");
    write("outside.txt", "nor this");
    fs::create_symlink(folder / "outside.txt", folder / "incoming" / "linked.ply");
    fs::create_symlink(folder / "nowhere", folder / "dangling.toml");
    for (const char* name : {"mine", "linked"}) upload(name);
    { const auto dropped = clouds.take("mine", "worse", ".ply"); }
    EXPECT_NE(refusalOf("dangling"), "");
    EXPECT_TRUE(fs::is_symlink(folder / "dangling.toml"));
    EXPECT_EQ(read("incoming/mine.ply"), "not the server's");
    EXPECT_EQ(read("outside.txt"), "nor this");
    EXPECT_EQ(read("linked.ply"), "points");
    EXPECT_EQ(clouds.withoutFolders((folder / "incoming" / "aB3xyz" / "mine.ply").string() + ": no"), "mine.ply: no");
}

} // namespace
} // namespace brume
