#include "server/operate/recording.h"

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/plain_file.h"
#include "common/whole_number.h"
#include "server/net/command_message.h"
#include "server/sim/state_hash.h"

namespace brume {
namespace {

using nlohmann::json;

constexpr char kMagic[] = "brume-recording ";
constexpr size_t kDigits = 16;
constexpr uint64_t kEndReserve = 256; // bytes, for the last line
// A scene's text has 1 MiB at most, and up to six characters for each in JSON. Rows of particles have kMostRowBytes in
// a tick, and four characters for three.
constexpr size_t kLongestLine = 64 << 20;

std::string magicLine() { return kMagic + std::to_string(kRecordingVersion); }

std::string hashOf(const std::string& before, const std::string& text) {
    StateHash hash;
    hash.add(before);
    hash.add(text);
    return hexOf(hash.value());
}

uint64_t fromHex(const std::string& digits) {
    uint64_t value = 0;
    const char* end = digits.data() + digits.size();
    const auto [at, error] = std::from_chars(digits.data(), end, value, 16);
    if (error != std::errc{} || at != end || digits.size() != kDigits) throw std::runtime_error("a hash has 16 digits");
    return value;
}

json toJson(const Command& command) { return {{"viewer", command.viewer}, {"input", net::textOf(command)}}; }
Command commandOf(const json& from) {
    if (from.size() != 2) throw std::runtime_error("a command has viewer and input");
    Command command = net::commandOf(from.at("input").get<std::string>());
    command.viewer = wholeNumber<uint32_t>(from.at("viewer"));
    return command;
}

// Four digits are enough for an estimate.
double rounded(double value) { return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr); }

json toJson(const RecordedError& recorded) {
    const ErrorEstimate& e = recorded.error;
    return {{"viewer", recorded.viewer}, {"method", recorded.method},  {"pixels", e.pixels},
            {"rmse", rounded(e.rmse)},   {"low", rounded(e.low)},      {"high", rounded(e.high)},
            {"bias", rounded(e.bias)},   {"predicted", rounded(e.law)}};
}

RecordedError errorOf(const json& from) {
    const auto notNegative = [&](const char* key) {
        const double value = from.at(key).get<double>();
        if (!(value >= 0)) throw std::runtime_error(fmt::format("an error's {} is negative", key));
        return value;
    };
    return {wholeNumber<uint32_t>(from.at("viewer")), from.at("method").get<std::string>(),
            ErrorEstimate{.pixels = wholeNumber<size_t>(from.at("pixels")),
                          .rmse = notNegative("rmse"),
                          .low = notNegative("low"),
                          .high = notNegative("high"),
                          .bias = from.at("bias").get<double>(),
                          .law = notNegative("predicted")}};
}

} // namespace

std::string hexOf(uint64_t value) { return fmt::format("{:016x}", value); }

// --- writing ---

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHead& head, uint64_t most_bytes)
    : file_(file.string()), most_bytes_(most_bytes) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) std::filesystem::rename(file, file_ + ".old", error);
    if (!error || error == std::errc::no_such_file_or_directory)
        fd_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
    if (fd_ < 0)
        throw RecordingError(
            fmt::format("{}: cannot be recorded to: {}", file_, error ? error.message() : std::strerror(errno)));
    try {
        writeBytes(magicLine() + '\n');
        hash_ = magicLine();
        writeLine(json{{"scene", head.scene},
                       {"file", head.file},
                       {"text", head.text},
                       {"overrides", head.overrides},
                       {"server", head.server},
                       {"tick", head.tick},
                       {"joined", head.joined}}
                      .dump());
    } catch (const json::exception&) { // text that is not UTF-8 is no TOML and was refused before
        ::close(fd_);
        throw RecordingError(file_ + ": the scene's text is not UTF-8");
    } catch (...) {
        ::close(fd_);
        throw;
    }
}

RecordingWriter::~RecordingWriter() { ::close(fd_); }

bool RecordingWriter::write(const RecordedTick& tick) {
    json line{{"tick", tick.tick}, {"state", hexOf(tick.state_hash)}};
    if (!tick.commands.empty()) {
        json& commands = line["commands"] = json::array();
        for (const Command& command : tick.commands) commands.push_back(toJson(command));
    }
    if (tick.frame) line["frame"] = hexOf(*tick.frame);
    if (!tick.end.empty()) line["end"] = tick.end;
    for (const RecordedError& error : tick.errors) line["errors"].push_back(toJson(error));
    const std::string text = line.dump();
    if (bytes_ + kDigits + text.size() + 2 + (tick.end.empty() ? kEndReserve : 0) > most_bytes_) return false;
    writeLine(text);
    return true;
}

void RecordingWriter::writeLine(const std::string& text) {
    const std::string hash = hashOf(hash_, text);
    writeBytes(hash + ' ' + text + '\n');
    hash_ = hash;
}

// What could not be written whole is taken back.
void RecordingWriter::writeBytes(const std::string& bytes) {
    for (size_t done = 0; done < bytes.size();) {
        const ssize_t count = ::write(fd_, bytes.data() + done, bytes.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            const int reason = errno;
            [[maybe_unused]] const int ignored = ::ftruncate(fd_, off_t(bytes_));
            throw RecordingError(fmt::format("{}: cannot be written: {}", file_, std::strerror(reason)));
        }
        done += size_t(count);
    }
    bytes_ += bytes.size();
}

// --- reading ---

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file.string()), in_(openPlain(file)) {
    if (!in_) throw RecordingError(file_ + ": cannot be read; allowed: a file that brume-server --record wrote");
    const auto first = line();
    if (!first || !first->starts_with(kMagic)) fail("no recording; allowed: a file that brume-server --record wrote");
    if (*first != magicLine())
        fail(
            fmt::format("version {}; this server replays version {}: use the server that recorded it, which the file's "
                        "second line names",
                        first->substr(sizeof kMagic - 1), kRecordingVersion));
    hash_ = *first;
    const auto text = verified();
    if (!text) fail("cut within its head: there is nothing to replay");
    try {
        const json head = json::parse(*text);
        head_ = {head.at("scene").get<std::string>(),  head.at("file").get<std::string>(),
                 head.at("text").get<std::string>(),   head.at("overrides").get<std::vector<std::string>>(),
                 head.at("server").get<std::string>(), head.contains("tick") ? wholeNumber(head.at("tick")) : 0,
                 head.value("joined", false)};
    } catch (const std::exception& e) {
        fail(fmt::format("not a recording's head: {}", e.what()));
    }
    if (head_.joined)
        fail(fmt::format("begins at tick {} with a state that came from other servers: replay the recording of the "
                         "server that began the log",
                         head_.tick));
}

void RecordingReader::fail(const std::string& what) const {
    throw RecordingError(fmt::format("{}:{}: {}", file_, number_, what));
}

std::optional<std::string> RecordingReader::line() {
    std::string text;
    for (int c; (c = in_.get()) != std::ifstream::traits_type::eof();) {
        if (c == '\n') {
            ++number_;
            return text;
        }
        if (text.size() == kLongestLine) {
            ++number_;
            fail(fmt::format("a line of more than {} bytes: the file is damaged", kLongestLine));
        }
        text += char(c);
    }
    if (in_.bad()) throw RecordingError(fmt::format("{}: cannot be read after line {}", file_, number_));
    cut_ = !text.empty();
    return {};
}

std::optional<std::string> RecordingReader::verified() {
    auto text = line();
    if (!text) return {};
    if (text->size() <= kDigits || (*text)[kDigits] != ' ' ||
        text->substr(0, kDigits) != hashOf(hash_, text->substr(kDigits + 1)))
        fail("damaged: this line or the one before was changed, left out or moved");
    hash_ = text->substr(0, kDigits);
    return text->substr(kDigits + 1);
}

std::optional<RecordedTick> RecordingReader::next() {
    const auto text = verified();
    if (!text) return {};
    if (ended_) fail("goes on after its end");
    RecordedTick out;
    try {
        const json line = json::parse(*text);
        out.tick = wholeNumber(line.at("tick"));
        out.state_hash = fromHex(line.at("state").get<std::string>());
        if (line.contains("commands"))
            for (const json& command : line.at("commands")) out.commands.push_back(commandOf(command));
        if (line.contains("frame")) out.frame = fromHex(line.at("frame").get<std::string>());
        if (line.contains("end")) out.end = line.at("end").get<std::string>();
        if (line.contains("errors"))
            for (const json& error : line.at("errors")) out.errors.push_back(errorOf(error));
    } catch (const std::exception& e) {
        fail(fmt::format("not a record: {}", e.what()));
    }
    ended_ = !out.end.empty();
    if (last_tick_ && (out.tick < *last_tick_ || (out.tick == *last_tick_ && !ended_)))
        fail(fmt::format("tick {} after tick {}", out.tick, *last_tick_));
    if (last_tick_ && out.tick - *last_tick_ > kRecordEvery)
        fail(fmt::format("tick {} after tick {}; a recording has a record every {} ticks at least", out.tick,
                         *last_tick_, kRecordEvery));
    if (!last_tick_ && out.tick != head_.tick) fail(fmt::format("does not begin at tick {}", head_.tick));
    last_tick_ = out.tick;
    return out;
}

} // namespace brume
