// The file of the key: taken whole, or refused in one line that names it.
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <unistd.h>

#include "server/net/token_key.h"

namespace brume {
namespace {

namespace fs = std::filesystem;

class TokenKey : public testing::Test {
protected:
    const fs::path file = fs::temp_directory_path() / ("brume-key-" + std::to_string(getpid()));
    void TearDown() override { fs::remove(file); }

    void put(const std::string& bytes, unsigned mode = 0600) const {
        fs::remove(file);
        std::ofstream(file, std::ios::binary) << bytes;
        fs::permissions(file, fs::perms(mode));
    }
    std::string complaint() const {
        try {
            readTokenKey(file);
            return "";
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }
    void refused(const std::string& words) const {
        const std::string said = complaint();
        EXPECT_NE(said.find(words), said.npos) << said;
        EXPECT_NE(said.find(file.string()), said.npos) << said;
        EXPECT_EQ(said.find('\n'), said.npos) << said;
    }
};

TEST_F(TokenKey, IsAllBytesOfItsFile) {
    const std::string bytes = std::string(31, 'x') + std::string("\0\n\xff", 3);
    put(bytes);
    EXPECT_EQ(readTokenKey(file), bytes);
    put(bytes, 0640);
    EXPECT_EQ(readTokenKey(file), bytes) << "a group may read it";
    put(std::string(4096, 'x'));
    EXPECT_EQ(readTokenKey(file).size(), 4096u);
}

TEST_F(TokenKey, TooShortOrTooLongIsNone) {
    for (const size_t size : {0, 1, 31, 4097, 100'000}) {
        put(std::string(size, 'x'));
        refused("32 to 4096 bytes");
    }
}

TEST_F(TokenKey, ThatOthersMayReadOrChangeIsNoSecret) {
    for (const unsigned mode : {0604u, 0602u, 0601u, 0644u, 0660u, 0666u}) {
        put(std::string(32, 'x'), mode);
        refused("others may read or change it");
    }
}

TEST_F(TokenKey, IsAFileThatIsThere) {
    refused("there is no such file");
    fs::create_directory(file);
    refused("is not a file");
}

} // namespace
} // namespace brume
