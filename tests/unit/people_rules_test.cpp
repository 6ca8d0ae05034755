// What viewers may say of themselves, and who may lead, by the rules alone.
#include "tests/unit/session_rules_fixture.h"

namespace brume::net::people_rules_test {
namespace {

using wire::ErrorCode;

class PeopleRulesTest : public SessionRulesTest {
protected:
    Actions presence(const char* name, const wire::Ray* pointer = nullptr, uint32_t follow = 0, bool cameras = false) {
        return say([&](FlatBufferBuilder& b) { return wire::CreatePresenceDirect(b, name, pointer, follow, cameras); });
    }
    Actions lead(uint32_t person) {
        return say([&](FlatBufferBuilder& b) { return wire::CreateLead(b, person); });
    }
    void watchAs(Role role) {
        rules.emplace(options, facts, now, Authorization{.role = role});
        watch();
    }
};

TEST_F(PeopleRulesTest, PresenceComesAfterHelloOnly) {
    EXPECT_EQ(onlyError(presence("Ann")), ErrorCode::unexpected);
    watch();
    const wire::Ray ray({1, 2, 3}, {0, 0, -4});
    const Presence said = only<SetPresence>(presence(" Ann\x07 ", &ray, 7, true)).presence;
    EXPECT_EQ(said.name, "Ann");
    EXPECT_EQ(said.follow, 7u);
    EXPECT_TRUE(said.cameras);
    ASSERT_TRUE(said.pointer);
    EXPECT_EQ(said.pointer->origin, glm::vec3(1, 2, 3));
    EXPECT_EQ(said.pointer->direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(only<SetPresence>(presence(nullptr)).presence.name, "");
}

TEST_F(PeopleRulesTest, PointersHaveFiniteRays) {
    watch();
    for (const wire::Ray& bad :
         {wire::Ray({kNan, 0, 0}, {0, 0, -1}), wire::Ray({0, 1e9f, 0}, {0, 0, -1}), wire::Ray({0, 0, 0}, {0, 0, 0}),
          wire::Ray({0, 0, 0}, {0, kInf, 0}), wire::Ray({0, 0, 0}, {0, kNan, 1})})
        EXPECT_EQ(onlyError(presence("Ann", &bad)), ErrorCode::out_of_range);
}

TEST_F(PeopleRulesTest, TheLastPresenceOverTheRateComesLater) {
    watch();
    pose({});
    for (int i = 0; i < 20; ++i) only<SetPresence>(presence("first"));
    EXPECT_TRUE(presence("second").empty());
    EXPECT_TRUE(presence("third").empty());
    EXPECT_EQ(only<SetPresence>(tick(100ms)).presence.name, "third");
    EXPECT_TRUE(tick(100ms).empty());
}

TEST_F(PeopleRulesTest, PresentersAndOperatorsLead) {
    for (const Role role : {Role::viewer, Role::pusher, Role::controller}) {
        watchAs(role);
        const auto refused = lead(3);
        EXPECT_EQ(onlyError(refused), ErrorCode::forbidden);
        EXPECT_NE(only<SendError>(refused).text.find("takes presenter"), std::string::npos);
    }
    for (const Role role : {Role::presenter, Role::operator_}) {
        watchAs(role);
        EXPECT_EQ(only<TakeLead>(lead(3)).person, 3u);
        EXPECT_EQ(only<TakeLead>(lead(0)).person, 0u);
        Actions out;
        rules->onUnknownPerson(3, now, out);
        EXPECT_EQ(onlyError(out), ErrorCode::unknown_name);
    }
}

TEST_F(PeopleRulesTest, ManyLeadsAreRefused) {
    watch();
    for (int i = 0; i < 20; ++i) only<TakeLead>(lead(3));
    EXPECT_EQ(onlyError(lead(3)), ErrorCode::too_fast);
}

TEST_F(PeopleRulesTest, PushersPushAndNothingElse) {
    watchAs(Role::pusher);
    const wire::Vec3 v(0, 0, 1);
    only<EnqueueCommand>(input(1, [&](auto& b) { return wire::CreateImpulse(b, &v, &v); }));
    EXPECT_EQ(onlyError(input(2, [&](auto& b) { return wire::CreateMoveVolume(b, &v); })), ErrorCode::forbidden);
    EXPECT_EQ(onlyError(input(3,
                              [&](auto& b) {
                                  const std::vector<flatbuffers::Offset<wire::Change>> changes{
                                      wire::CreateChangeDirect(b, "medium.falloff", 1.5)};
                                  return wire::CreateSetDirect(b, &changes);
                              })),
              ErrorCode::forbidden);
    EXPECT_EQ(onlyError(restart(4)), ErrorCode::forbidden);
    watchAs(Role::viewer);
    EXPECT_EQ(onlyError(input(1, [&](auto& b) { return wire::CreateImpulse(b, &v, &v); })), ErrorCode::forbidden);
}

TEST_F(PeopleRulesTest, RolesHaveAnOrder) {
    constexpr Role kOrder[] = {Role::viewer, Role::pusher, Role::controller, Role::presenter, Role::operator_};
    for (size_t i = 0; i < std::size(kOrder); ++i)
        for (size_t k = 0; k < std::size(kOrder); ++k) EXPECT_EQ(atLeast(kOrder[i], kOrder[k]), i >= k);
    for (const Role role : kOrder) EXPECT_EQ(roleNamed(nameOf(role)), role);
    EXPECT_STREQ(nameOf(Role::presenter), "presenter");
}

} // namespace
} // namespace brume::net::people_rules_test
