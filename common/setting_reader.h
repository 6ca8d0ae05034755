// Reads settings of a scene file by the table of settings.
#pragma once

#include <filesystem>
#include <string_view>
#include <utility>
#include <variant>

#include "common/scene_reader.h"
#include "common/settings.h"

namespace brume {

// Reads the settings of one table into the scene.
class SettingReader {
public:
    explicit SettingReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // All of one table ("medium.emitter", "" for the file's top). `origin`: what places count from; without it they are
    // displacements.
    void readTable(TableReader& in, std::string_view table, const SceneParts& parts, const glm::dvec3* origin) const {
        for (const SceneSetting& setting : sceneSettings())
            if (setting.table() == table) std::visit(Read{in, setting, origin, folder_}, setting.member(parts));
    }
    void readOne(TableReader& in, std::string_view path, const SceneParts& parts) const {
        for (const SceneSetting& setting : sceneSettings())
            if (setting.path == path) std::visit(Read{in, setting, nullptr, folder_}, setting.member(parts));
    }

private:
    struct Read {
        TableReader& in;
        const SceneSetting& setting;
        const glm::dvec3* origin;
        const std::filesystem::path& folder;

        void operator()(bool* out) const { in.boolean(setting.key(), *out); }
        void operator()(float* out) const {
            if (setting.form == Form::height && origin)
                in.height(setting.key(), *out, *origin);
            else if (setting.form == Form::or_auto)
                in.numberOrAuto(setting.key(), *out, setting.allowed);
            else if (setting.form == Form::unit)
                in.numberOrUnit(setting.key(), *out, setting.allowed);
            else
                in.number(setting.key(), *out, setting.allowed, setting.unit);
        }
        void operator()(uint32_t* out) const {
            if (setting.form == Form::or_auto)
                in.integerOrAuto(setting.key(), *out, setting.allowed);
            else
                in.integer(setting.key(), *out, setting.allowed);
        }
        void operator()(uint64_t* out) const { in.integer(setting.key(), *out, setting.allowed); }
        void operator()(glm::vec3* out) const {
            if (setting.form == Form::place && origin)
                in.place(setting.key(), *out, *origin);
            else
                in.vector(setting.key(), *out, setting.allowed);
            if (setting.form == Form::direction) normalise(*out);
        }
        void operator()(glm::dvec3* out) const {
            if (!in.isAuto(setting.key())) in.vector(setting.key(), *out, setting.allowed);
        }
        void operator()(Range* out) const { in.range(setting.key(), *out, setting.allowed); }
        void operator()(std::string* out) const {
            if (setting.choices.empty())
                in.text(setting.key(), *out, static_cast<size_t>(setting.allowed.hi));
            else if (const auto chosen = in.choice(setting.key(), setting.choices))
                *out = setting.choices[*chosen];
        }
        void operator()(Layout* out) const {
            if (const auto chosen = in.choice(setting.key(), setting.choices)) *out = static_cast<Layout>(*chosen);
        }
        void operator()(std::filesystem::path* out) const {
            std::string file;
            in.text(setting.key(), file, static_cast<size_t>(setting.allowed.hi));
            if (!file.empty()) *out = folder / file;
        }
        void normalise(glm::vec3& direction) const {
            const float length = glm::length(direction);
            if (!(length > 1e-6f)) in.fail(setting.key(), "has no direction", "any vector longer than 1e-6");
            direction /= length;
        }
    };

    std::filesystem::path folder_;
};

} // namespace brume
