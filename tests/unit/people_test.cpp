// People: names, whose camera each viewer has, and what is told of them.
#include "server/viewer/people.h"

#include <gtest/gtest.h>

#include "server/viewer/audience.h"
#include "tests/unit/take_due.h"

namespace brume::people_test {
namespace {

struct PeopleTest : testing::Test {
    Audience audience{{}, sceneFacts({}), 100, 2};
    People& people = audience.people();

    std::shared_ptr<Viewer> come(const std::string& token = {}, const std::string& key = {}) {
        return audience.join(nullptr, {.key = key, .token = token, .role = 3, .is_person = true}).viewer;
    }
    void look(const std::shared_ptr<Viewer>& who, uint32_t seq, float x, uint16_t width = 640, uint8_t views = 1) {
        PoseRequest request = poseWithSeq(seq);
        request.pose.position.x = x;
        request.width = width;
        request.views = views;
        people.look(who->id(), request);
    }
    void follow(const std::shared_ptr<Viewer>& who, uint32_t whom) { people.say(who->id(), {.follow = whom}); }
    static float seenAt(const std::shared_ptr<Viewer>& who) { return who->pose().value().pose.position.x; }
    Person of(const std::shared_ptr<Viewer>& who) const {
        for (const Person& one : people.now().people)
            if (one.id == who->id()) return one;
        ADD_FAILURE() << "nobody of that id";
        return {};
    }
};

TEST_F(PeopleTest, NamesHaveNothingThatHarms) {
    EXPECT_EQ(personName("Ann"), "Ann");
    EXPECT_EQ(personName("  Zo\xc3\xab \t\n  M\xc3\xbcller "), "Zo\xc3\xab M\xc3\xbcller");
    EXPECT_EQ(personName("\xe6\x9d\x8e"), "\xe6\x9d\x8e");
    EXPECT_EQ(personName("<b>x</b>"), "<b>x</b>") << "it is shown as text, never as markup";
    EXPECT_EQ(personName("a\x1b[31mb\x7f"), "a[31mb") << "no escapes of terminals";
    EXPECT_EQ(personName("a\xe2\x80\xae"
                         "b"),
              "ab")
        << "no marks of direction";
    EXPECT_EQ(personName("a\xe2\x80\x8b"
                         "b"),
              "ab")
        << "no width of nothing";
    EXPECT_EQ(personName("\xff\xc0\xaf\xed\xa0\x80\xf8ok\xe2\x80"), "ok") << "what is no UTF-8 is left out";
    EXPECT_EQ(personName(std::string(100, 'x')), std::string(kMostNameCharacters, 'x'));
    EXPECT_EQ(personName(""), "");
    EXPECT_EQ(personName(" \xc2\xa0\xe3\x80\x80"), "");
}

TEST_F(PeopleTest, EachHasANameAndAColour) {
    const auto ann = come("ann"), guest = come();
    EXPECT_EQ(of(ann).name, "ann");
    EXPECT_TRUE(of(ann).known);
    EXPECT_EQ(of(guest).name, "Guest " + std::to_string(guest->id()));
    people.say(guest->id(), {.name = "Bob"});
    people.say(ann->id(), {.name = "somebody else"});
    EXPECT_EQ(of(guest).name, "Bob");
    EXPECT_FALSE(of(guest).known);
    EXPECT_EQ(of(ann).name, "ann") << "a token's name stays";
    EXPECT_NE(of(ann).colour, of(guest).colour);
    const uint32_t colour = of(ann).colour;
    audience.leave(ann);
    EXPECT_EQ(of(come()).colour, colour) << "a colour that is free is given again";
    EXPECT_EQ(of(come("ann")).role, 3);
}

TEST_F(PeopleTest, WhoFollowsHasTheSamePicturesUntilItMoves) {
    const auto ann = come(), bob = come();
    look(ann, 1, 5, 800);
    look(bob, 1, 7, 320);
    follow(bob, ann->id());
    EXPECT_EQ(of(bob).follows, ann->id());
    EXPECT_TRUE(samePictures(*ann->pose(), *bob->pose())) << "they cost one picture";
    EXPECT_EQ(bob->pose()->follows, ann->id());
    look(ann, 2, 6, 800);
    EXPECT_EQ(seenAt(bob), 6);
    look(bob, 2, 8, 320); // kept for later
    EXPECT_EQ(seenAt(bob), 6);
    EXPECT_EQ(bob->pose()->width, 800);
    follow(bob, 0);
    EXPECT_EQ(seenAt(bob), 8);
    EXPECT_EQ(bob->pose()->width, 320);
    EXPECT_EQ(bob->pose()->follows, 0u);
    look(bob, 3, 9, 320);
    EXPECT_EQ(seenAt(bob), 9);
}

TEST_F(PeopleTest, AHiddenFollowerStaysHidden) {
    const auto ann = come(), bob = come();
    look(ann, 1, 5);
    look(bob, 1, 7);
    follow(bob, ann->id());
    PoseRequest hidden = poseWithSeq(2);
    hidden.hidden = true;
    people.look(bob->id(), hidden);
    look(ann, 2, 6);
    EXPECT_TRUE(bob->pose()->hidden);
    EXPECT_FALSE(of(bob).look);
    hidden.seq = 3, hidden.hidden = false;
    people.look(bob->id(), hidden);
    EXPECT_FALSE(bob->pose()->hidden);
    EXPECT_EQ(seenAt(bob), 6);
    hidden.seq = 3, hidden.hidden = true;
    people.look(ann->id(), hidden); // who leads and looks away leaves the others where they are
    EXPECT_FALSE(bob->pose()->hidden);
}

TEST_F(PeopleTest, AllFollowWhoPresents) {
    const auto ann = come(), bob = come(), eve = come();
    look(ann, 1, 5);
    look(bob, 1, 7);
    look(eve, 1, 9);
    follow(eve, bob->id());
    EXPECT_EQ(seenAt(eve), 7);
    EXPECT_TRUE(people.lead(ann->id()));
    EXPECT_EQ(people.now().presenter, ann->id());
    EXPECT_EQ(seenAt(bob), 5);
    EXPECT_EQ(seenAt(eve), 5);
    const auto late = come();
    look(late, 1, 3);
    EXPECT_EQ(seenAt(late), 5) << "who comes later follows, too";
    EXPECT_TRUE(people.lead(0));
    EXPECT_EQ(seenAt(bob), 7);
    EXPECT_EQ(seenAt(eve), 7) << "whom it followed before";
    EXPECT_EQ(seenAt(late), 3);
    EXPECT_FALSE(people.lead(999));
    EXPECT_TRUE(people.lead(bob->id())); // an operator may give the lead to another
    EXPECT_EQ(seenAt(ann), 7);
    audience.leave(bob);
    EXPECT_EQ(people.now().presenter, 0u) << "it ends with the presenter";
    EXPECT_EQ(seenAt(ann), 5);
    EXPECT_EQ(seenAt(eve), 9);
}

TEST_F(PeopleTest, RingsAndChainsOfFollowersEnd) {
    const auto a = come(), b = come(), c = come();
    look(a, 1, 1);
    look(b, 1, 2);
    look(c, 1, 3);
    follow(a, b->id());
    follow(b, c->id());
    EXPECT_EQ(seenAt(a), 3) << "through the second";
    EXPECT_EQ(of(a).follows, c->id());
    follow(c, a->id()); // a ring
    for (const auto& one : {a, b, c}) EXPECT_EQ(of(one).follows, 0u);
    EXPECT_EQ(seenAt(b), 2);
    follow(c, 0);
    EXPECT_EQ(seenAt(a), 3);
    follow(a, a->id()); // itself
    EXPECT_EQ(seenAt(a), 1);
    follow(a, 999); // nobody
    EXPECT_EQ(of(a).follows, 0u);
}

TEST_F(PeopleTest, TwoEyesKeepTheirOwnCamera) {
    const auto ann = come(), headset = come();
    look(ann, 1, 5);
    look(headset, 1, 7, 640, 2);
    follow(headset, ann->id());
    people.lead(ann->id());
    EXPECT_EQ(seenAt(headset), 7);
    EXPECT_EQ(of(headset).follows, 0u);
    // But others may have theirs.
    people.lead(headset->id());
    EXPECT_EQ(seenAt(ann), 7);
    EXPECT_EQ(ann->pose()->views, 1);
}

TEST_F(PeopleTest, WhoComesBackIsTheSamePersonAndHasItsOwnCamera) {
    const auto ann = come();
    auto bob = come();
    look(ann, 1, 5);
    look(bob, 9, 7);
    follow(bob, ann->id());
    audience.leave(bob, true);
    const auto back = come({}, bob->key());
    EXPECT_EQ(back->id(), bob->id());
    EXPECT_EQ(of(back).follows, 0u);
    look(back, 1, 8); // its numbers begin anew
    EXPECT_EQ(seenAt(back), 8);
    EXPECT_EQ(back->pose()->follows, 0u);
}

TEST_F(PeopleTest, OldPosesAreLeftOut) {
    const auto ann = come();
    look(ann, 5, 5);
    look(ann, 4, 4);
    EXPECT_EQ(seenAt(ann), 5);
    const auto bob = come();
    look(bob, 1, 7);
    follow(bob, ann->id());
    look(bob, 1, 8);
    follow(bob, 0);
    EXPECT_EQ(seenAt(bob), 7);
}

TEST_F(PeopleTest, VersionsGrowWithWhatThereIsToTell) {
    const auto ann = come();
    const auto grows = [&](bool cameras, const auto& change) {
        const uint64_t before = people.version(cameras);
        change();
        return people.version(cameras) > before;
    };
    EXPECT_TRUE(grows(true, [&] { look(ann, 1, 5); }));
    EXPECT_FALSE(grows(false, [&] { look(ann, 2, 6); })) << "who looks where is told to who asked";
    EXPECT_TRUE(grows(false, [&] { people.say(ann->id(), {.name = "Ann"}); }));
    EXPECT_TRUE(grows(false, [&] { come(); }));
    EXPECT_TRUE(grows(false, [&] { people.lead(ann->id()); }));
    EXPECT_TRUE(grows(false, [&] { audience.leave(ann); }));
}

TEST_F(PeopleTest, PointersAreAnsweredInTurn) {
    const auto ann = come(), bob = come();
    const PointingRay ray{{0, 0, 9}, {0, 0, -1}};
    people.say(bob->id(), {.pointer = ray});
    people.say(ann->id(), {.pointer = ray});
    const auto first = people.takeMoved(1);
    ASSERT_EQ(first.size(), 1u);
    EXPECT_EQ(first[0].id, bob->id());
    EXPECT_EQ(people.takeMoved(9).at(0).id, ann->id());
    EXPECT_TRUE(people.takeMoved(9).empty()) << "none has moved since";
    people.meets(first[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(of(bob).pointer, glm::vec3(1, 2, 3));
    people.say(bob->id(), {});
    EXPECT_FALSE(of(bob).pointer);
    people.meets(first[0], glm::vec3(1, 2, 3));
    EXPECT_FALSE(of(bob).pointer) << "it points no more";
}

TEST_F(PeopleTest, OfManyTheFirstAreToldOfAndWhoPresents) {
    std::vector<std::shared_ptr<Viewer>> all;
    for (size_t i = 0; i < kMostPeople + 6; ++i) all.push_back(come());
    EXPECT_EQ(people.now().people.size(), kMostPeople);
    EXPECT_EQ(people.now().count, kMostPeople + 6);
    people.lead(all.back()->id());
    EXPECT_EQ(people.now().people.size(), kMostPeople);
    EXPECT_EQ(people.now().people.back().id, all.back()->id());
    people.lead(all.front()->id());
    EXPECT_EQ(people.now().people.size(), kMostPeople);
    EXPECT_EQ(people.now().people.front().id, all.front()->id());
}

TEST_F(PeopleTest, WhoTakesPicturesByAUrlIsNoPerson) {
    const auto snapshot = audience.join(nullptr, {.token = "ann"}).viewer;
    EXPECT_EQ(people.now().count, 0u);
    audience.leave(snapshot);
}

} // namespace
} // namespace brume::people_test
