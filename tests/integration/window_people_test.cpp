// The whole window of the native client, on SDL's dummy driver, which keeps each picture that is shown as a file:
// others' dots and cones in it, and what others see of its user's cursor.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <SDL2/SDL.h>
#include <gtest/gtest.h>

#include "client/native/people.h"
#include "client/native/window.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test::window_people_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr int kWidth = 320, kHeight = 180;
constexpr float kAspect = float(kWidth) / kHeight;

// A folder of its own, in which SDL writes the pictures. The process is in it meanwhile.
class PicturesFolder {
public:
    PicturesFolder() : folder_(fs::temp_directory_path() / ("brume-window-" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        before_ = fs::current_path();
        fs::current_path(folder_);
    }
    ~PicturesFolder() {
        fs::current_path(before_);
        fs::remove_all(folder_);
    }
    // How many pixels of the newest whole picture have a colour, at most `around` pixels from a place. The older
    // pictures are deleted. 0 without a picture.
    int pixelsOf(uint32_t colour, int x, int y, int around) const {
        std::vector<fs::path> pictures;
        for (const auto& entry : fs::directory_iterator(folder_)) pictures.push_back(entry.path());
        std::ranges::sort(pictures);
        if (pictures.empty()) return 0;
        SDL_Surface* const read = SDL_LoadBMP(pictures.back().c_str());
        if (!read) return 0; // it is being written
        pictures.pop_back();
        for (const fs::path& old : pictures) fs::remove(old);
        SDL_Surface* const picture = SDL_ConvertSurfaceFormat(read, SDL_PIXELFORMAT_RGB888, 0);
        int count = 0;
        for (int row = y - around; row <= y + around; ++row) {
            const auto* pixels = reinterpret_cast<const uint32_t*>(static_cast<const uint8_t*>(picture->pixels) +
                                                                   ptrdiff_t(row) * picture->pitch);
            for (int column = x - around; column <= x + around; ++column)
                count += (pixels[column] & 0xffffff) == colour;
        }
        SDL_FreeSurface(picture);
        SDL_FreeSurface(read);
        return count;
    }

private:
    fs::path folder_, before_;
};

// The window's program in a thread of its own, until the window is closed.
class RunningWindow {
public:
    explicit RunningWindow(const client::Options& options)
        : thread_([options] {
              client::Interrupt interrupt;
              EXPECT_NO_THROW(client::runWindow(options, interrupt));
          }) {}
    ~RunningWindow() {
        SDL_Event event{};
        event.type = SDL_QUIT;
        SDL_PushEvent(&event);
        thread_.join();
    }
    static void press(SDL_Keycode key) {
        SDL_Event event{};
        event.type = SDL_KEYDOWN;
        event.key.keysym.sym = key;
        SDL_PushEvent(&event);
    }
    static void moveCursor(int x, int y) {
        SDL_Event event{};
        event.type = SDL_MOUSEMOTION;
        event.motion.x = x, event.motion.y = y;
        SDL_PushEvent(&event);
    }

private:
    std::thread thread_;
};

class WindowPeople : public testing::Test {
protected:
    WindowPeople() : ann_(server_.endpoint(), wishesOf("Ann")) {
        setPaused(ann_, true);
        const client::Granted& granted = ann_.session.granted();
        camera_ = lookAt(granted.position, granted.target, granted.fov_y);
        options_.servers = {server_.endpoint()};
        options_.wishes = wishesOf("Ben");
    }
    static client::Wishes wishesOf(const char* name) {
        client::Wishes wishes{.width = kWidth, .height = kHeight};
        wishes.name = name;
        return wishes;
    }
    client::Ray through(int x, int y) const {
        return client::cursorRay(camera_, (float(x) + 0.5f) / kWidth, (float(y) + 0.5f) / kHeight, kAspect);
    }
    // Receives messages for Ann until the condition holds.
    bool annSees(const std::function<bool()>& until) {
        for (const auto end = steady_clock::now() + kPatience; steady_clock::now() < end;) {
            if (until()) return true;
            const auto message = ann_.session.next(milliseconds(20));
            if (!message) continue;
            if (const auto* frame = message->as<wire::Frame>()) ann_.session.acknowledge(frame->id());
            states_ += message->as<wire::SceneState>() ? 1 : 0;
            if (const auto* people = message->as<wire::People>()) people_ = client::peopleOf(*people);
        }
        return false;
    }
    // Of id 0 if there is nobody of that name.
    client::Person named(const char* name) const {
        for (const client::Person& person : people_)
            if (person.name == name) return person;
        return {};
    }

    static void SetUpTestSuite() {
        setenv("SDL_VIDEODRIVER", "dummy", 1);
        setenv("SDL_VIDEO_DUMMY_SAVE_FRAMES", "1", 1);
    }
    static void TearDownTestSuite() { unsetenv("SDL_VIDEO_DUMMY_SAVE_FRAMES"); }

    RunningServer server_{{"--scene", "cloud"}};
    PicturesFolder pictures_;
    Watcher ann_;
    client::Options options_;
    Pose camera_; // the scene's own
    std::vector<client::Person> people_;
    int states_ = 0; // that Ann has received
};

// Ann stands where the window looks from, so that her dot is where her ray goes, at whatever depth.
TEST_F(WindowPeople, ADotIsWhereSomebodyElsePoints) {
    const RunningWindow window(options_);
    ASSERT_TRUE(annSees([&] { return named("Ben").id != 0; }));
    ann_.session.appear({.pointer = through(150, 80)});
    ASSERT_TRUE(annSees([&] { return named("Ann").pointer.has_value(); }));
    const uint32_t colour = named("Ann").colour;
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(colour, 150, 80, 3) == 49; }));
    EXPECT_EQ(pictures_.pixelsOf(colour, 150, 80, 7), pictures_.pixelsOf(colour, 150, 80, 12)) << "no larger";
    ann_.session.appear({});
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(colour, 150, 80, 12) == 0; })) << "it ends";
}

TEST_F(WindowPeople, ItsUserPointsWhileTIsOn) {
    const RunningWindow window(options_);
    ASSERT_TRUE(annSees([&] { return named("Ben").id != 0; }));
    window.press(SDLK_t);
    window.moveCursor(170, 100);
    ASSERT_TRUE(annSees([&] { return named("Ben").pointer.has_value(); }));
    const client::Ray ray = through(170, 100);
    const glm::vec3 way = *named("Ben").pointer - ray.origin;
    EXPECT_LT(glm::length(glm::cross(way, ray.direction)), 1e-3f * glm::length(way));
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(named("Ben").colour, 170, 100, 3) == 49; })) << "its own";
    window.press(SDLK_t);
    EXPECT_TRUE(annSees([&] { return !named("Ben").pointer; }));
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(named("Ben").colour, 170, 100, 12) == 0; }));
    window.moveCursor(120, 90);
    ASSERT_TRUE(annSees([&, before = states_] { return states_ >= before + 2; })) << "a second or two";
    EXPECT_FALSE(named("Ben").pointer);
}

// Ann's picture is 320 x 80 pixels in the window's middle.
TEST_F(WindowPeople, ItsUserPointsThroughAPictureWithMargins) {
    ann_.session.sendPose(camera_, 400, 100);
    options_.wishes.follow = "Ann";
    const RunningWindow window(options_);
    ASSERT_TRUE(annSees([&] { return named("Ben").id != 0; }));
    window.press(SDLK_t);
    const client::Ray ray = client::cursorRay(camera_, 150.5f / 320, 30.5f / 80, 4);
    const auto along = [&] { // the cursor moves before the picture has come, too
        window.moveCursor(150, 80);
        if (!named("Ben").pointer) return false;
        const glm::vec3 way = *named("Ben").pointer - ray.origin;
        return glm::length(glm::cross(way, ray.direction)) < 1e-3f * glm::length(way);
    };
    EXPECT_TRUE(annSees(along));
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(named("Ben").colour, 150, 80, 3) == 49; }));
}

TEST_F(WindowPeople, ConesAreDrawnWhileCIsOn) {
    const glm::vec3 place = camera_.position + 15.0f * through(96, 126).direction;
    ann_.look(lookAt(place, {0, 0, 0}, 0.8f));
    const RunningWindow window(options_);
    ASSERT_TRUE(annSees([&] { return named("Ben").id != 0; }));
    const uint32_t colour = named("Ann").colour;
    EXPECT_EQ(pictures_.pixelsOf(colour, 96, 126, 3), 0) << "off at first";
    window.press(SDLK_c);
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(colour, 96, 126, 3) > 0; })) << "its tip is where Ann is";
    window.press(SDLK_c);
    EXPECT_TRUE(annSees([&] { return pictures_.pixelsOf(colour, 96, 126, 12) == 0; }));
}

} // namespace
} // namespace brume::test::window_people_test
