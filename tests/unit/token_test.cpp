// Tokens: what is good, and everything near it that is not.
#include <cmath>

#include <gtest/gtest.h>

#include "server/net/access.h"
#include "server/net/rate.h"
#include "server/net/rooms.h"
#include "server/net/token.h"

namespace brume::net {
namespace {

using namespace std::chrono_literals;

const std::string kKey(kLeastKeyBytes, 'k');
const Seconds kNow{1'800'000'000s};

std::string faultOf(std::string_view token, std::string_view key = kKey, Seconds now = kNow) {
    const auto read = readToken(token, key, now);
    const auto* fault = std::get_if<TokenFault>(&read);
    return fault ? *fault : "";
}

std::string good(Role role = Role::viewer) { return makeToken({role, kNow + 1h, "ann"}, kKey); }

TEST(Token, SaysWhoMayDoWhatUntilWhen) {
    for (const Role role : {Role::viewer, Role::controller, Role::operator_}) {
        const auto read = readToken(good(role), kKey, kNow);
        ASSERT_TRUE(std::holds_alternative<Claims>(read)) << std::get<TokenFault>(read);
        const auto& claims = std::get<Claims>(read);
        EXPECT_EQ(claims.role, role);
        EXPECT_EQ(claims.expires, kNow + 1h);
        EXPECT_EQ(claims.name, "ann");
    }
    EXPECT_EQ(roleNamed("operator"), Role::operator_);
    EXPECT_EQ(roleNamed("root"), std::nullopt);
}

TEST(Token, MayBeOfOneRoomAlone) {
    for (const std::string& room : {std::string(), std::string("lab"), std::string(kMostRoomName, 'z')}) {
        const auto read = readToken(makeToken({Role::viewer, kNow + 1h, "ann", room}, kKey), kKey, kNow);
        ASSERT_TRUE(std::holds_alternative<Claims>(read)) << std::get<TokenFault>(read);
        EXPECT_EQ(std::get<Claims>(read).room, room);
    }
    EXPECT_NE(faultOf(makeToken({Role::viewer, kNow + 1h, "", std::string(kMostRoomName + 1, 'z')}, kKey)), "");
    for (const char* room : {"a/b", "..", " ", "z\xc3\xb6", "lab\n"})
        EXPECT_NE(faultOf(makeToken({Role::viewer, kNow + 1h, "", room}, kKey)), "") << room;
}

// The form is public: made by the coreutils and openssl from {"exp":1800003600,"role":"viewer"} and 32 times k.
TEST(Token, IsWhatOthersMakeOfTheSame) {
    EXPECT_EQ(makeToken({Role::viewer, Seconds(1'800'003'600s), ""}, kKey),
              "eyJleHAiOjE4MDAwMDM2MDAsInJvbGUiOiJ2aWV3ZXIifQ.UMzRRKXzLr5SWd2B4EzyFgBjDzZxAhU_HnV08oxdh-8");
}

TEST(Token, AlteredInAnyByteIsNone) {
    const std::string token = good();
    for (size_t at = 0; at < token.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            std::string altered = token;
            altered[at] = char(altered[at] ^ (1 << bit));
            EXPECT_NE(faultOf(altered), "") << "byte " << at << ", bit " << bit;
        }
    for (size_t size = 0; size < token.size(); ++size) EXPECT_NE(faultOf(token.substr(0, size)), "") << size;
    EXPECT_NE(faultOf(token + "="), "");
    EXPECT_NE(faultOf(token + "A"), "");
    EXPECT_NE(faultOf(" " + token), "");
}

TEST(Token, OfAnotherKeyIsNone) {
    EXPECT_EQ(faultOf(good(), std::string(kLeastKeyBytes, 'j')), "the token was not made with this server's key");
    EXPECT_NE(faultOf(good(), std::string(kLeastKeyBytes + 1, 'k')), "");
}

TEST(Token, EndsAtItsTimeAndTheClocksTolerance) {
    const std::string token = good();
    EXPECT_EQ(faultOf(token, kKey, kNow + 1h + kClockSkew - 1s), "");
    EXPECT_EQ(faultOf(token, kKey, kNow + 1h + kClockSkew), "the token has expired");
    const auto ahead = [](std::chrono::seconds life) {
        return faultOf(makeToken({Role::viewer, kNow + life, ""}, kKey));
    };
    EXPECT_EQ(ahead(kLongestToken + kClockSkew), "");
    EXPECT_NE(ahead(kLongestToken + kClockSkew + 1s), "");
}

// Signed, and still not of the form.
TEST(Token, ContentIsExactlyWhatIsDocumented) {
    EXPECT_TRUE(readClaims("eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIifQ")) << R"({"exp":1,"role":"viewer"})";
    for (
        const char* payload : {
            "",
            "e30",                                                        // {}
            "W10",                                                        // []
            "MQ",                                                         // 1
            "eyJleHAiOjF9",                                               // {"exp":1}
            "eyJyb2xlIjoidmlld2VyIn0",                                    // {"role":"viewer"}
            "eyJleHAiOi0xLCJyb2xlIjoidmlld2VyIn0",                        // {"exp":-1,"role":"viewer"}
            "eyJleHAiOjEuNSwicm9sZSI6InZpZXdlciJ9",                       // {"exp":1.5,"role":"viewer"}
            "eyJleHAiOjFlOTksInJvbGUiOiJ2aWV3ZXIifQ",                     // {"exp":1e99,"role":"viewer"}
            "eyJleHAiOjk5OTk5OTk5OTk5OTk5OTk5OTksInJvbGUiOiJ2aWV3ZXIifQ", // {"exp":9999999999999999999,"role":"viewer"}
            "eyJleHAiOjEsInJvbGUiOiJyb290In0",                            // {"exp":1,"role":"root"}
            "eyJleHAiOjEsInJvbGUiOjN9",                                   // {"exp":1,"role":3}
            "eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIiLCJhIjoxfQ",                 // {"exp":1,"role":"viewer","a":1}
            "eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIiLCJuYW1lIjoiXG4ifQ",         // {"exp":1,"role":"viewer","name":"\n"}
            "eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIiLCJyb29tIjoiIn0",            // {"exp":1,"role":"viewer","room":""}
            "eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIiLCJyb29tIjoxfQ",             // {"exp":1,"role":"viewer","room":1}
            "eyJleHAiOjEsInJvbGUiOiJ2aWV3ZXIiLCJyb29tIjpudWxsfQ",         // {"exp":1,"role":"viewer","room":null}
        })
        EXPECT_FALSE(readClaims(payload)) << payload;
}

TEST(Token, OverItsLengthIsNotEvenSigned) {
    EXPECT_EQ(faultOf(std::string(kMostTokenBytes + 1, 'a')), "the token is over 512 bytes");
    const std::string name(kMostTokenName, '"'), room(kMostRoomName, 'z');
    EXPECT_LE(makeToken({Role::controller, kNow, name, room}, kKey).size(), kMostTokenBytes);
}

TEST(Access, ComesWithTheHeaderOrTheQueryAndOneLineSaysWhatIsMissing) {
    NetOptions options;
    EXPECT_EQ(std::get<Authorization>(authorize("", "", Role::operator_, options)).role, Role::operator_) << "open";
    options.token_key = kKey;
    const auto soon = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) + 60s;
    const std::string token = makeToken({Role::controller, soon, "ann"}, kKey);
    const auto status = [&](const std::string& header, const std::string& query, Role least = Role::viewer) {
        const auto checked = authorize(header, query, least, options);
        const auto* refusal = std::get_if<Reply>(&checked);
        if (!refusal) return 200u;
        EXPECT_EQ(refusal->body.find('\n'), refusal->body.size() - 1) << "one line";
        return refusal->status;
    };
    EXPECT_EQ(status("Bearer " + token, ""), 200u);
    EXPECT_EQ(status("bearer " + token, "w=640"), 200u);
    EXPECT_EQ(status("", "w=640&token=" + token), 200u);
    EXPECT_EQ(status("", "token=" + token, Role::controller), 200u);
    EXPECT_EQ(status("", "token=" + token, Role::operator_), 403u);
    EXPECT_EQ(status("", ""), 401u);
    EXPECT_EQ(status("", "token="), 401u);
    EXPECT_EQ(status("", "token=" + token + "&token=" + token), 401u) << "a name comes once";
    EXPECT_EQ(status("Basic " + token, ""), 401u);
    EXPECT_EQ(status("Bearer x", "token=" + token), 401u) << "the header goes first";
    const auto until = *std::get<Authorization>(authorize("Bearer " + token, "", Role::viewer, options)).until;
    EXPECT_NEAR(std::chrono::duration<double>(until - Clock::now()).count(), 60 + kClockSkew.count(), 2);
}

TEST(Access, ATokenOfARoomIsGoodThereAloneWhateverItsRole) {
    NetOptions options;
    options.token_key = kKey;
    const auto soon = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) + 60s;
    const auto answer = [&](Role role, const char* of, Role least, const char* in) {
        const auto checked = authorize("Bearer " + makeToken({role, soon, "ann", of}, kKey), "", least, options, in);
        const auto* refusal = std::get_if<Reply>(&checked);
        return refusal ? std::to_string(refusal->status) + " " + refusal->body : "";
    };
    EXPECT_EQ(answer(Role::viewer, "lab", Role::viewer, "lab"), "");
    EXPECT_EQ(answer(Role::operator_, "lab", Role::operator_, "lab"), "");
    EXPECT_EQ(answer(Role::viewer, "lab", Role::operator_, "lab").substr(0, 3), "403");
    const std::string elsewhere = "403 this token is good in the room 'lab' alone: below /r/lab/\n";
    for (const char* in : {"", "den", "la", "labs", "LAB"})
        EXPECT_EQ(answer(Role::operator_, "lab", Role::viewer, in), elsewhere) << in;
    for (const char* in : {"", "den", "lab"}) EXPECT_EQ(answer(Role::viewer, "", Role::viewer, in), "") << in;
}

TEST(Rate, ABucketIsFullAgainAfterItsBurst) {
    TokenBucket bucket(10, 2);
    const auto start = TokenBucket::Time::now();
    EXPECT_TRUE(bucket.full(start));
    EXPECT_TRUE(bucket.take(start) && bucket.take(start) && !bucket.take(start));
    EXPECT_FALSE(bucket.full(start + 150ms));
    EXPECT_TRUE(bucket.full(start + 200ms));
    EXPECT_TRUE(bucket.take(start + 101ms));
}

} // namespace
} // namespace brume::net
