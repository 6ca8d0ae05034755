// What a scene may not say, and the message for each: file, line, key, problem, and what is allowed.
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/scene_file.h"

namespace brume {
namespace {

using test::errorOf, test::written;

struct Wrong {
    const char* text;
    int line;
    const char* key;
    const char* problem;
    const char* allowed;
};

class WrongScene : public testing::TestWithParam<Wrong> {};

TEST_P(WrongScene, NamesFileLineKeyAndWhatIsAllowed) {
    const Wrong& wrong = GetParam();
    const std::string message = errorOf(wrong.text);
    const std::string start = written("").string() + ':' + std::to_string(wrong.line) + ": " + wrong.key + ": ";
    EXPECT_EQ(message.substr(0, start.size()), start) << message;
    EXPECT_NE(message.find(wrong.problem), std::string::npos) << message;
    const size_t allowed = message.find("; allowed: ");
    ASSERT_NE(allowed, std::string::npos) << message;
    EXPECT_NE(message.find(wrong.allowed, allowed), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongScene,
    testing::Values(
        Wrong{"nam = \"x\"", 1, "nam", "unknown key",
              "box, camera, fog, glass, light, medium, mesh, name, objects, origin, plane, render, simulation, sky, "
              "sphere"},
        Wrong{"[medium]\nlayout = \"cube\"\n\ncuont=3", 4, "medium.cuont", "unknown key; did you mean count?", "count"},
        Wrong{"[[light]]\ncolour = [1, 1, 1]", 2, "light[0].colour", "unknown key", "irradiance"},
        Wrong{"[medium]\nlayout = \"emitter\"\ncount = 9000\n[medium.emitter]\nspeed = 3", 5, "medium.emitter.speed",
              "unknown key", "velocity"},
        Wrong{"[medium]\ncount = 0", 2, "medium.count", "0 is not", "a whole number from 1 to 1000000"},
        Wrong{"[medium]\ncount = 1000001", 2, "medium.count", "1000001 is not", "from 1 to 1000000"},
        Wrong{"[medium]\ncount = 5.5", 2, "medium.count", "5.5 is not", "a whole number"},
        Wrong{"[medium]\ncount = \"many\"", 2, "medium.count", "\"many\" is not", "a whole number"},
        Wrong{"[medium]\nextinction = nan", 2, "medium.extinction", "nan is not", "a number from 0"},
        Wrong{"[medium]\nextinction = -inf", 2, "medium.extinction", "-inf is not", "a number from 0"},
        Wrong{"[medium]\nextinction = true", 2, "medium.extinction", "true is not", "a number from 0"},
        Wrong{"[medium]\nfalloff = 0", 2, "medium.falloff", "0 is not", "from 0.1 to 10"},
        Wrong{"[medium]\nasymmetry = 1", 2, "medium.asymmetry", "1 is not", "from -0.99 to 0.99"},
        Wrong{"[medium]\nalbedo = [0.5, 1.5, 0.5]", 2, "medium.albedo", "is not", "from 0 to 1"},
        Wrong{"[medium]\nalbedo = [0.5, 0.5]", 2, "medium.albedo", "an array of 2", "[x, y, z]"},
        Wrong{"[medium]\nextinction_colour = [0.5, -0.5, 0.5]", 2, "medium.extinction_colour", "is not", "from 0 to 1"},
        Wrong{"[[glass]]\ntransmittance = [0.5, 1.5, 0.5]", 2, "glass[0].transmittance", "is not", "from 0 to 1"},
        Wrong{"[medium]\nalbedo = 0.5", 2, "medium.albedo", "0.5 is not", "[x, y, z]"},
        Wrong{"[medium]\nscale = [3, 2]", 2, "medium.scale", "upside down", "lowest first"},
        Wrong{"[medium]\nscale = [1, 2, 3]", 2, "medium.scale", "an array of 3", "[lowest, highest]"},
        Wrong{"[medium]\nscale = 0", 2, "medium.scale", "0 is not", "from 0.001"},
        Wrong{"[medium]\nseed = -1", 2, "medium.seed", "-1 is not", "from 0"},
        Wrong{"[medium]\nseed = 9223372036854775807", 2, "medium.seed", "9223372036854775807 is not", "from 0"},
        Wrong{"[medium]\nlayout = \"ball\"", 2, "medium.layout", "\"ball\"",
              "\"cube\", \"tubes\", \"cumulus\", \"emitter\", \"file\""},
        Wrong{"[medium]\nlayout = \"file\"", 2, "medium.layout", "without a file", "a PLY"},
        Wrong{"[medium]\nfile = \"a.ply\"", 2, "medium.file", "not used", "layout = \"file\""},
        Wrong{"[medium]\nlayout = \"file\"\nfile = \"a.ply\"\ncount = 3", 4, "medium.count", "not used",
              "the file says"},
        Wrong{"[medium]\nmodel = \"tetrahedra\"", 2, "medium.model", "come from a file", "layout = \"file\""},
        Wrong{"[medium]\nlayout = \"sequence\"\nfile = \"a#.ply\"\nmodel = \"tetrahedra\"", 4, "medium.model",
              "come from a file", "layout = \"file\""},
        Wrong{"[medium]\n[medium.emitter]\nrate = 1", 2, "medium.emitter", "not used", "layout = \"emitter\""},
        Wrong{"[medium]\nlayout = \"emitter\"\ncount = 99\nemitter = { rate = 50, life = 2 }", 3, "medium.count",
              "smaller than", "from 101"},
        Wrong{"medium = 3", 1, "medium", "3 is not", "a table"},
        Wrong{"light = 3", 1, "light", "3 is not", "[[light]], from 0 to 1025 of them"},
        Wrong{"light = [3]", 1, "light", "3 is not", "a table"},
        Wrong{"[[light]]\n[[light]]\n", 1, "light", "more than one is directional", "points or spots"},
        Wrong{"[[light]]\nto_light = [0, 0, 0]", 2, "light[0].to_light", "no direction", "any vector"},
        Wrong{"[[light]]\ntype = \"lamp\"", 2, "light[0].type", "\"lamp\"", "\"directional\""},
        Wrong{"[[fog]]\nextinction = -1", 2, "fog[0].extinction", "-1 is not", "from 0 to 10000"},
        Wrong{"[[fog]]\nlo = 3\nhi = 2", 3, "fog[0].hi", "ends below where it begins", "lo below hi"},
        Wrong{"[[fog]]\nphase = \"schlick\"", 2, "fog[0].phase", "\"schlick\"", "\"droplets\""},
        Wrong{"[[fog]]\n[[fog]]\n[[fog]]\n[[fog]]\n[[fog]]", 1, "fog", "5", "0 to 4"},
        Wrong{"[medium]\nlayout = \"none\"\ncount = 3", 3, "medium.count", "not used", "no particles"},
        Wrong{"[[sphere]]\n\n[[sphere]]\nradius = -1", 4, "sphere[1].radius", "-1 is not", "from 0.001"},
        Wrong{"[[plane]]\nstructure = 1.5", 2, "plane[0].structure", "1.5 is not", "a number from 0 to 1"},
        Wrong{"[[box]]\nsize = [1, 0, 1]", 2, "box[0].size", "is not", "from 0.001"},
        Wrong{"[camera]\nposition = [1, 2, 3]\ntarget = [1, 2, 3]", 3, "camera.target", "is where the camera stands",
              "any place"},
        Wrong{"[camera]\nposition = [1e6, 0, 0]", 2, "camera.position", "1000000 is not", "near the scene's origin"},
        Wrong{"origin = [1e6, 0, 0]\n[[sphere]]\ncentre = [0, 0, 0]", 3, "sphere[0].centre", "0 is not",
              "from 950000 to 1050000"},
        Wrong{"origin = [0, 1e6, 0]\n[[plane]]\nheight = 0", 3, "plane[0].height", "0 is not",
              "near the scene's origin"},
        Wrong{"origin = [0, 2e7, 0]", 1, "origin", "20000000 is not", "from -10000000 to 10000000"},
        Wrong{"[camera]\nfov_y = 3.2", 2, "camera.fov_y", "3.2 is not", "a number of radians from 0.05 to 3"},
        Wrong{"[camera]\nfov_y = 45", 2, "camera.fov_y", "45 is not", "radians"},
        Wrong{"[[mesh]]\n\n[[mesh]]\nfile = \"none.glb\"", 1, "mesh[0].file", "without a file", ".glb"},
        Wrong{"[[mesh]]\nfile = \"none.glb\"", 2, "mesh[0].file", "none.glb is no file", ".glb"},
        Wrong{"[simulation]\npaused = 1", 2, "simulation.paused", "1 is not", "true or false"},
        Wrong{"[render]\nmethod = \"\"", 2, "render.method", "\"\" is not", "text of 1 to 64"},
        Wrong{"[render]\nquadrature = \"simpson\"", 2, "render.quadrature", "unknown key", "method"},
        Wrong{"[render.isv]\nquadrature = \"gauss\"", 2, "render.isv.quadrature", "\"gauss\"",
              "\"simpson\", \"transmittance\", \"analytic\", \"taylor\""},
        Wrong{"[render.isv]\nsteps = 11", 2, "render.isv.steps", "11 is not", "from 1 to 10"},
        Wrong{"[render.isv]\nquadrature = \"transmittance\"\nsteps = 4", 3, "render.isv.steps", "4 is not",
              "from 1 to 3"},
        Wrong{"[render]\nshadow_slices = 1", 2, "render.shadow_slices", "1 is not",
              "\"auto\", or a whole number from 2 to 193"},
        Wrong{"[render]\nshadow_size = 0", 2, "render.shadow_size", "0 is not",
              "\"auto\", or a whole number from 8 to 1024"},
        Wrong{"[render]\nrate = \"automatic\"", 2, "render.rate", "\"automatic\" is not",
              "\"auto\", or a whole number from 1 to 16"},
        Wrong{"[render.grid]\nspacing = 0", 2, "render.grid.spacing", "0 is not", "\"auto\", or a number from 0.01"},
        Wrong{"[render]\nshading = 6", 2, "render.shading", "6 is not", "\"auto\", 1, 2, 4 or 8"},
        Wrong{"[render]\nmerge = 8.5", 2, "render.merge", "8.5 is not", "from 0 to 8"},
        Wrong{"[render]\nshadow_error = 0", 2, "render.shadow_error", "0 is not", "from 0.0001 to 0.1"},
        Wrong{"name = 1979-05-27", 1, "name", "a date or time", "text"},
        Wrong{"name = \"a\"\nname = \"b\"", 2, "syntax", "name", "TOML"}, Wrong{"[medium\n", 1, "syntax", "", "TOML"},
        Wrong{"name = no", 1, "syntax", "", "quotes"}, Wrong{"name = cube", 1, "syntax", "", "quotes"},
        Wrong{"[medium]\n[sky]\n[medium]\n", 3, "syntax", "medium", "stands first"}));

} // namespace
} // namespace brume
