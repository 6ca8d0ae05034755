// UploadedClouds: the folder of clouds that viewers gave. Each is NAME.ply or NAME.nrrd, and NAME.toml, a scene of it.
//
// The folder may hold files of others. What the server wrote is known by the scene's first line, which has a hash of
// the rest, that file's size and the time when they were written: whoever edits or replaces them makes them his own.
#pragma once

#include <filesystem>
#include <string>

namespace brume {

class UploadedClouds {
public:
    static constexpr size_t kMost = 16; // clouds that are kept

    explicit UploadedClouds(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // A cloud that is not known to be good: in a folder of its own, until keep() or its end.
    class Incoming {
    public:
        // Throws SceneError if the bytes cannot be written.
        Incoming(const std::filesystem::path& folder, const std::string& name, const std::string& bytes,
                 const std::string& ending);
        ~Incoming() { discard(); }
        Incoming(const Incoming&) = delete;
        Incoming& operator=(const Incoming&) = delete;

        // NAME.toml beside the bytes, where no file is yet.
        std::filesystem::path scene() const;
        // Keeps the bytes and this scene of them, in place of those of the same name. The clouds that were not used
        // for longest go when there are more than kMost. Returns the scene's file. Throws SceneError: the scene
        // is not replaced.
        std::filesystem::path keep(const std::string& text);

    private:
        void discard() const;

        const std::filesystem::path kept_, bytes_; // the scene's file, once it is kept; the cloud's, until then
    };

    // Throws SceneError if the name belongs to files that the server did not write, or if nothing can be written.
    // `ending`: of the file's name, ".ply" or ".nrrd".
    Incoming take(const std::string& name, const std::string& bytes, const std::string& ending) const;

    // A complaint as the sender of a cloud understands it: files without the folders that they are kept in.
    std::string withoutFolders(std::string complaint) const;

private:
    const std::filesystem::path folder_;
};

} // namespace brume
