#include "server/net/token.h"

#include <algorithm>
#include <array>
#include <vector>

#include <nlohmann/json.hpp>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "server/net/rooms.h"

namespace brume::net {
namespace {

using Json = nlohmann::json;

// RFC 4648, section 5, without padding.
std::string base64Url(const unsigned char* bytes, size_t size) {
    std::vector<unsigned char> out(4 * ((size + 2) / 3) + 1);
    const int length = EVP_EncodeBlock(out.data(), bytes, int(size));
    std::string text(out.begin(), out.begin() + length);
    while (text.ends_with('=')) text.pop_back();
    std::replace(text.begin(), text.end(), '+', '-');
    std::replace(text.begin(), text.end(), '/', '_');
    return text;
}

std::optional<std::string> fromBase64Url(std::string_view text) {
    const auto ours = [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    if (text.empty() || text.size() > kMostTokenBytes || !std::all_of(text.begin(), text.end(), ours)) return {};
    std::string padded(text);
    std::replace(padded.begin(), padded.end(), '-', '+');
    std::replace(padded.begin(), padded.end(), '_', '/');
    padded.append((4 - padded.size() % 4) % 4, '=');
    std::vector<unsigned char> out(padded.size());
    const int length =
        EVP_DecodeBlock(out.data(), reinterpret_cast<const unsigned char*>(padded.data()), int(padded.size()));
    const size_t padding = padded.size() - text.size();
    if (length < 0 || padding > 2) return {};
    return std::string(out.begin(), out.begin() + length - std::ptrdiff_t(padding)); // OpenSSL decodes padding as zeros
}

std::string signatureOf(std::string_view payload, std::string_view key) {
    unsigned char mac[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    HMAC(EVP_sha256(), key.data(), int(key.size()), reinterpret_cast<const unsigned char*>(payload.data()),
         payload.size(), mac, &size);
    return base64Url(mac, size);
}

bool printable(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

// Each may do what those before it may.
constexpr std::array<Role, 5> kRanks{Role::viewer, Role::pusher, Role::controller, Role::presenter, Role::operator_};

// End of the year 9999 in seconds since 1970; a clock's type can hold it.
constexpr int64_t kLastSecond = 253'402'300'799;

} // namespace

// The role's name in texts. flatc's EnumNameRole() says operator_, since operator is a keyword of C++.
const char* nameOf(Role role) { return role == Role::operator_ ? "operator" : wire::EnumNameRole(role); }

bool atLeast(Role role, Role least) {
    const auto rank = [](Role one) { return std::ranges::find(kRanks, one) - kRanks.begin(); };
    return rank(role) >= rank(least);
}

std::optional<Role> roleNamed(std::string_view name) {
    for (const Role role : wire::EnumValuesRole())
        if (name == nameOf(role)) return role;
    return {};
}

std::optional<Claims> readClaims(std::string_view payload) {
    const auto text = fromBase64Url(payload);
    if (!text) return {};
    const Json json = Json::parse(*text, nullptr, false);
    if (!json.is_object()) return {};
    Claims claims;
    bool any_time = false, any_role = false;
    for (const auto& [key, value] : json.items()) {
        if (key == "exp" && value.is_number_integer()) {
            const auto seconds = value.is_number_unsigned() && value.get<uint64_t>() > uint64_t(kLastSecond)
                                     ? int64_t(-1)
                                     : value.get<int64_t>();
            if (seconds < 0 || seconds > kLastSecond) return {};
            claims.expires = Seconds(std::chrono::seconds(seconds));
            any_time = true;
        } else if (key == "role" && value.is_string()) {
            const auto role = roleNamed(value.get_ref<const std::string&>());
            if (!role) return {};
            claims.role = *role;
            any_role = true;
        } else if (key == "name" && value.is_string()) {
            claims.name = value.get<std::string>();
            if (claims.name.size() > kMostTokenName || !printable(claims.name)) return {};
        } else if (key == "room" && value.is_string()) {
            claims.room = value.get<std::string>();
            if (!isRoomName(claims.room)) return {};
        } else {
            return {};
        }
    }
    return any_time && any_role ? std::optional(claims) : std::nullopt;
}

std::variant<Claims, TokenFault> readToken(std::string_view token, std::string_view key, Seconds now) {
    if (token.size() > kMostTokenBytes) return "the token is over 512 bytes";
    const size_t dot = token.find('.');
    if (dot == token.npos) return "this is no token";
    const std::string_view payload = token.substr(0, dot), signature = token.substr(dot + 1);
    const std::string expected = signatureOf(payload, key);
    if (signature.size() != expected.size() || CRYPTO_memcmp(signature.data(), expected.data(), expected.size()) != 0)
        return "the token was not made with this server's key";
    const auto claims = readClaims(payload);
    if (!claims) return "the token's content is not of the form that is documented";
    if (now >= claims->expires + kClockSkew) return "the token has expired";
    if (claims->expires > now + kLongestToken + kClockSkew)
        return "the token is good for more than 24 h, which none may be";
    return *claims;
}

std::string makeToken(const Claims& claims, std::string_view key) {
    Json json{{"exp", claims.expires.time_since_epoch().count()}, {"role", nameOf(claims.role)}};
    if (!claims.name.empty()) json["name"] = claims.name;
    if (!claims.room.empty()) json["room"] = claims.room;
    const std::string text = json.dump();
    const std::string payload = base64Url(reinterpret_cast<const unsigned char*>(text.data()), text.size());
    return payload + "." + signatureOf(payload, key);
}

} // namespace brume::net
