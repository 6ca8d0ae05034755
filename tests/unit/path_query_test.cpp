// Key views in an address, as client/web/src/camera-keys.ts writes them.
#include <gtest/gtest.h>

#include "server/net/path_query.h"

namespace brume::net::path_query_test {
namespace {

std::vector<CameraKey> keysIn(std::string_view text) {
    const auto read = readPathQuery(text);
    const auto* wrong = std::get_if<std::string>(&read);
    EXPECT_EQ(wrong, nullptr) << *wrong;
    return wrong ? std::vector<CameraKey>() : std::get<std::vector<CameraKey>>(read);
}

TEST(PathQuery, HasTheKeyViewsOfAPage) {
    EXPECT_TRUE(keysIn("").empty());
    const auto keys = keysIn("0,2,26,0,0,0,0.8,0_10.123,2,-20,0,1,0,0.75,2.5");
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].position, glm::vec3(0, 2, 26));
    EXPECT_EQ(keys[1].position, glm::vec3(10.123f, 2, -20));
    EXPECT_EQ(keys[1].target, glm::vec3(0, 1, 0));
    EXPECT_EQ(keys[1].fov_y, 0.75f);
    EXPECT_EQ(keys[1].seconds, 2.5f);
}

TEST(PathQuery, SaysWhichKeyIsWrong) {
    const std::string good = "0,2,26,0,0,0,0.8,0", other = "1,2,-20,0,1,0,0.75,2.5";
    for (const char* bad : {"", "1,2,3", "1,2,-20,0,1,0,0.75,0", "1,2,-20,0,1,0,0.75,601", "1,2,-20,0,1,0,3.1,2",
                            "1,2,-50001,0,1,0,0.75,2", "1,2,nan,0,1,0,0.75,2", "1,2,3,1,2,3,0.75,2",
                            "1,2,-20,0,1,0,0.75,2,1", "1,2,-20,0,1,0,0.75,2x"}) {
        const auto read = readPathQuery(good + '_' + bad);
        ASSERT_TRUE(std::holds_alternative<std::string>(read)) << bad;
        EXPECT_TRUE(std::get<std::string>(read).starts_with(*bad ? "key view 2 of path" : "key view 1 of path")) << bad;
    }
    std::string many = good;
    for (int i = 0; i < 63; ++i) many += '_' + other;
    EXPECT_EQ(keysIn(many).size(), 64u);
    EXPECT_EQ(std::get<std::string>(readPathQuery(many + '_' + other)), "path has at most 64 key views");
}

} // namespace
} // namespace brume::net::path_query_test
