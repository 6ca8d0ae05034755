// The frozen example messages, and what a parser must not accept.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/protocol_examples.h"

namespace brume::wire {
namespace {

const std::string kFolder = "protocol/examples/"; // tests run in the source folder

std::vector<uint8_t> readBytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

Json expectations() { return Json::parse(readBytes(kFolder + "examples.json")); }

TEST(ProtocolExamples, FrozenBytesSayWhatTheyAlwaysSaid) {
    const auto expected = expectations();
    ASSERT_FALSE(expected.empty());
    for (const auto& [name, meaning] : expected.items()) {
        const auto bytes = readBytes(kFolder + name + ".bin");
        const auto message = parse(bytes);
        ASSERT_TRUE(message) << name;
        EXPECT_EQ(describe(*message), meaning) << name;
    }
}

TEST(ProtocolExamples, WhatIsPackedTodayMeansTheSame) {
    const auto expected = expectations();
    const auto made = makeExamples();
    EXPECT_EQ(made.size(), expected.size());
    for (const auto& example : made) {
        const auto message = parse(example.bytes);
        ASSERT_TRUE(message) << example.name;
        ASSERT_TRUE(expected.contains(example.name)) << example.name;
        EXPECT_EQ(describe(*message), expected.at(example.name)) << example.name;
    }
}

TEST(ProtocolExamples, EveryBodyAndCommandHasOne) {
    std::set<std::string> seen;
    const Json expected = expectations();
    for (const auto& [name, meaning] : expected.items()) {
        seen.insert(meaning.at("type"));
        if (meaning.at("body").contains("command_type")) seen.insert(meaning.at("body").at("command_type"));
    }
    for (const Body body : EnumValuesBody())
        if (body != Body::NONE) {
            EXPECT_TRUE(seen.contains(EnumNameBody(body))) << EnumNameBody(body);
        }
    for (const Command command : EnumValuesCommand())
        if (command != Command::NONE) {
            EXPECT_TRUE(seen.contains(EnumNameCommand(command))) << EnumNameCommand(command);
        }
}

TEST(ProtocolParse, NoCutOfAnyExampleIsAMessage) {
    for (const auto& example : makeExamples())
        for (size_t size = 0; size < example.bytes.size(); ++size) {
            // A copy of exactly that size, so that a sanitizer sees a read beyond it.
            const std::vector<uint8_t> cut(example.bytes.begin(), example.bytes.begin() + ptrdiff_t(size));
            EXPECT_FALSE(parse(cut)) << example.name << " cut to " << size;
        }
}

TEST(ProtocolParse, NothingMayFollow) {
    for (auto example : makeExamples()) {
        example.bytes.push_back(0);
        EXPECT_FALSE(parse(example.bytes)) << example.name;
    }
}

TEST(ProtocolParse, TheIdentifierAndTheLengthAreChecked) {
    for (const auto& example : makeExamples()) {
        auto other = example.bytes;
        other[8] ^= 1; // "BRM1"
        EXPECT_FALSE(parse(other)) << example.name;
        auto longer = example.bytes;
        longer[3] = 0xff;
        EXPECT_FALSE(parse(longer)) << example.name;
        auto shorter = example.bytes;
        shorter[0] -= 4;
        EXPECT_FALSE(parse(shorter)) << example.name;
    }
}

// Every single byte replaced by a few values: whatever parses can be read to its last field without touching other
// memory (the address sanitizer build proves that; here it must at least not crash).
TEST(ProtocolParse, DamagedBytesAreRefusedOrSafeToRead) {
    size_t accepted = 0, refused = 0;
    for (const auto& example : makeExamples())
        for (size_t at = 0; at < example.bytes.size(); ++at)
            for (const uint8_t value :
                 {uint8_t(0), uint8_t(1), uint8_t(0x7f), uint8_t(0xff), uint8_t(example.bytes[at] ^ 0x04)}) {
                auto damaged = example.bytes;
                damaged[at] = value;
                if (const auto message = parse(damaged)) {
                    ++accepted;
                    EXPECT_FALSE(describe(*message).empty());
                } else {
                    ++refused;
                }
            }
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
}

TEST(ProtocolParse, AnUnknownBodyOrCommandIsNotAMessage) {
    const auto setByte = [](const flatbuffers::Table* table, flatbuffers::voffset_t field, uint8_t value) {
        *const_cast<uint8_t*>(table->GetAddressOf(field)) = value;
    };
    for (auto example : makeExamples()) {
        const Message* message = GetSizePrefixedMessage(example.bytes.data());
        const auto* root = reinterpret_cast<const flatbuffers::Table*>(message);
        if (const Input* input = message->body_as_Input()) {
            const auto* table = reinterpret_cast<const flatbuffers::Table*>(input);
            const uint8_t command = uint8_t(input->command_type());
            for (const int unknown : {0, int(Command::MAX) + 1, 255}) {
                setByte(table, Input::VT_COMMAND_TYPE, uint8_t(unknown));
                EXPECT_FALSE(parse(example.bytes)) << example.name << ", command " << unknown;
            }
            setByte(table, Input::VT_COMMAND_TYPE, command);
            EXPECT_TRUE(parse(example.bytes));
        }
        for (const int unknown : {0, int(Body::MAX) + 1, 255}) {
            setByte(root, Message::VT_BODY_TYPE, uint8_t(unknown));
            EXPECT_FALSE(parse(example.bytes)) << example.name << ", body " << unknown;
        }
    }
}

TEST(ProtocolParse, FrameLengthsMustAddUp) {
    const Vec3 position(0, 0, 0);
    const Quat orientation(0, 0, 0, 1);
    const Stages stages(0, 0, 0, 0, 0);
    const auto parses = [&](std::vector<uint32_t> lengths, size_t jpeg_bytes) {
        const Packed header = pack([&](auto& b) {
            return CreateFrameDirect(b, 1, 1, 1, 1, 1, &position, &orientation, 0.8f, 64, 64, 80, &stages, &lengths);
        });
        std::vector<uint8_t> bytes(header.data(), header.data() + header.size());
        bytes.insert(bytes.end(), jpeg_bytes, uint8_t{0});
        return parse(bytes).has_value();
    };
    EXPECT_TRUE(parses({10}, 10));
    EXPECT_TRUE(parses({4, 6}, 10));
    EXPECT_FALSE(parses({10}, 9));
    EXPECT_FALSE(parses({4, 6}, 11));
    EXPECT_FALSE(parses({}, 0));
    EXPECT_FALSE(parses({1, 1, 1}, 3));
    EXPECT_FALSE(parses({0xffffffff, 11}, 10)); // the sum does not wrap around
}

// Layers of each view, or none; of each the lengths of three pictures.
TEST(ProtocolParse, LengthsOfLayersMustAddUp) {
    const Vec3 position(0, 0, 0);
    const Quat orientation(0, 0, 0, 1);
    const Stages stages(0, 0, 0, 0, 0);
    const auto parses = [&](std::vector<std::vector<uint32_t>> of_layers, size_t all_bytes) {
        const Packed header = pack([&](auto& b) {
            const std::vector<uint32_t> pictures{10};
            std::vector<flatbuffers::Offset<DepthLayers>> layers;
            for (const auto& lengths : of_layers) {
                const auto packed = b.CreateVector(lengths);
                DepthLayersBuilder one(b);
                one.add_bytes(packed);
                layers.push_back(one.Finish());
            }
            const auto packed = b.CreateVector(layers);
            const auto jpeg = b.CreateVector(pictures);
            FrameBuilder frame(b);
            frame.add_position(&position);
            frame.add_orientation(&orientation);
            frame.add_stages(&stages);
            frame.add_jpeg_bytes(jpeg);
            frame.add_layers(packed);
            return frame.Finish();
        });
        std::vector<uint8_t> bytes(header.data(), header.data() + header.size());
        bytes.insert(bytes.end(), all_bytes, uint8_t{0});
        return parse(bytes).has_value();
    };
    EXPECT_TRUE(parses({{1, 2, 3}}, 16));
    EXPECT_TRUE(parses({{0, 0, 0}}, 10));
    EXPECT_FALSE(parses({{1, 2, 3}}, 10));
    EXPECT_FALSE(parses({{1, 2, 3}}, 17));
    EXPECT_FALSE(parses({{1, 2}}, 13));
    EXPECT_FALSE(parses({{1, 2, 3, 4}}, 20));
    EXPECT_FALSE(parses({{1, 0, 0}, {1, 0, 0}}, 12)) << "there is one view";
    EXPECT_FALSE(parses({{0xffffffff, 0xffffffff, 8}}, 16)) << "the sum does not wrap around";
}

// As a client of one's own does it in languages whose libraries have no FinishSizePrefixed: its fields of eight bytes
// are aligned to another place.
TEST(ProtocolFraming, AMessageThatWasFinishedWithoutItsSizeIsRead) {
    flatbuffers::FlatBufferBuilder builder;
    const Vec3 position(1.5f, -2, 3);
    const Quat orientation(0, 0, 0, 1);
    for (const uint32_t seq : {1u, 2u}) {
        builder.Clear();
        if (seq == 2) builder.CreateString("moves what follows");
        const auto pose = CreatePose(builder, seq, 0x0102'0304'0506'0708, &position, &orientation);
        FinishMessageBuffer(builder, CreateMessage(builder, Body::Pose, pose.Union()));
        std::vector<uint8_t> bytes(sizeof(uint32_t));
        flatbuffers::WriteScalar(bytes.data(), builder.GetSize());
        bytes.insert(bytes.end(), builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
        const auto message = parse(bytes);
        ASSERT_TRUE(message) << whyNot(bytes);
        ASSERT_TRUE(message->as<Pose>());
        EXPECT_EQ(message->as<Pose>()->seq(), seq);
        EXPECT_EQ(message->as<Pose>()->client_time_us(), 0x0102'0304'0506'0708u);
        EXPECT_EQ(message->as<Pose>()->position()->z(), 3);
        bytes.push_back(0);
        EXPECT_FALSE(parse(bytes)) << "followed by another byte";
    }
}

TEST(ProtocolFraming, WhatIsNoMessageIsToldWhy) {
    const std::vector<uint8_t> none(5), text(40, 'x');
    EXPECT_NE(whyNot(none).find("5 bytes"), std::string::npos);
    EXPECT_NE(whyNot(text).find("36"), std::string::npos) << "that follow";
    std::vector<uint8_t> other(40);
    other[0] = 36;
    EXPECT_NE(whyNot(other).find("BRM1"), std::string::npos);
    std::copy_n("BRM1", 4, other.begin() + 8);
    EXPECT_FALSE(parse(other));
    EXPECT_NE(whyNot(other).find("damaged"), std::string::npos);
}

} // namespace
} // namespace brume::wire
