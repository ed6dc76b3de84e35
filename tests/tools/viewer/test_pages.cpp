// Pictures on their way to pages: the newest alone, two at a time, never an older one after it.
#include <random>

#include <gtest/gtest.h>

#include "tools/viewer/pages.h"

using namespace supple;
using namespace supple::tools;

namespace {

struct Sent {
  std::uint32_t event, number;
  std::shared_ptr<const FrameMessage> frame;
};

class Recorder final : public PageOutlet {
 public:
  void send_text(std::shared_ptr<const std::string> text) override { texts.push_back(*text); }
  void send_frame(std::vector<std::uint8_t> head,
                  std::shared_ptr<const FrameMessage> frame) override {
    const auto word = [&](std::size_t at) {
      return std::uint32_t(head[at]) | std::uint32_t(head[at + 1]) << 8 |
             std::uint32_t(head[at + 2]) << 16 | std::uint32_t(head[at + 3]) << 24;
    };
    frames.push_back({word(4), word(8), std::move(frame)});
  }
  std::vector<std::string> texts;
  std::vector<Sent> frames;
};

FrameMessage frame(Pages& pages, std::uint64_t number, int view = 0) {
  FrameMessage message;
  message.stamp = pages.next_stamp();
  message.number = number;
  message.view = view;
  message.picture = {1, 2, 3};
  return message;
}

}  // namespace

TEST(UnitPages, AtMostTwoPicturesAreOnTheirWayAndOfTheRestTheNewestFollows) {
  Pages pages;
  const auto page = std::make_shared<Recorder>();
  const int id = pages.join(page, "hello");
  for (std::uint64_t n = 1; n <= 10; ++n) {
    pages.note(id, n, std::uint32_t(n));
    pages.publish(frame(pages, n));
  }
  ASSERT_EQ(page->frames.size(), 2u);
  EXPECT_EQ(page->frames[1].event, 2u);
  pages.acknowledge(id, page->frames[0].number);
  ASSERT_EQ(page->frames.size(), 3u);
  EXPECT_EQ(page->frames[2].event, 10u);
  pages.acknowledge(id, 12345);
  pages.acknowledge(id, page->frames[1].number);
  EXPECT_EQ(page->frames.size(), 3u);
}

TEST(UnitPages, AnOlderPictureThatComesLaterIsLeftOut) {
  Pages pages;
  const auto page = std::make_shared<Recorder>();
  const int id = pages.join(page, "");
  pages.note(id, 1, 1);
  pages.note(id, 2, 2);
  const FrameMessage old = frame(pages, 1), other = frame(pages, 1, 1);
  pages.publish(frame(pages, 2));
  pages.publish(old);
  ASSERT_EQ(page->frames.size(), 1u);
  EXPECT_EQ(page->frames[0].event, 2u);
  pages.publish(other);
  ASSERT_EQ(page->frames.size(), 2u);
  EXPECT_EQ(page->frames[1].event, 1u);  // what it shows, though another view is further
}

TEST(UnitPages, PicturesAtRestGoBesideTheOthersOfTheirViewUntilTheyAreForgotten) {
  Pages pages;
  const auto early = std::make_shared<Recorder>(), late = std::make_shared<Recorder>();
  pages.join(early, "");
  FrameMessage at_rest = frame(pages, 1);
  at_rest.is_at_rest = true;
  pages.publish(frame(pages, 1));
  pages.publish(at_rest);
  ASSERT_EQ(early->frames.size(), 2u);
  EXPECT_FALSE(early->frames[0].frame->is_at_rest);
  EXPECT_TRUE(early->frames[1].frame->is_at_rest);
  pages.forget_frames_at_rest();
  pages.join(late, "");
  ASSERT_EQ(late->frames.size(), 1u);
  EXPECT_FALSE(late->frames[0].frame->is_at_rest);
}

TEST(UnitPages, EachPageCountsItsOwnEvents) {
  Pages pages;
  const auto one = std::make_shared<Recorder>(), two = std::make_shared<Recorder>();
  const int first = pages.join(one, "");
  pages.note(first, 1, 7);
  pages.publish(frame(pages, 1));
  const int second = pages.join(two, "");
  ASSERT_EQ(two->frames.size(), 1u);  // what is there
  EXPECT_EQ(two->frames[0].event, 0u);
  pages.note(second, 2, 1);
  pages.publish(frame(pages, 2));
  EXPECT_EQ(one->frames.back().event, 7u);
  EXPECT_EQ(two->frames.back().event, 1u);
  pages.leave(first);
  pages.publish(frame(pages, 2));
  EXPECT_EQ(one->frames.size(), 2u);
  EXPECT_EQ(pages.count(), 1u);
}

TEST(UnitPages, ASceneTellsEachPageTheLastEventThatItShows) {
  Pages pages;
  const auto one = std::make_shared<Recorder>(), two = std::make_shared<Recorder>();
  const int first = pages.join(one, "");
  pages.join(two, "");
  EXPECT_EQ(one->texts.back(), "{\"scene\":null}");
  pages.note(first, 5, 3);
  pages.tell_scene({{"volume", "a}}b"}}, 5);
  EXPECT_EQ(one->texts.back(), "{\"scene\":{\"volume\":\"a}}b\",\"event\":3}}");
  EXPECT_EQ(two->texts.back(), "{\"scene\":{\"volume\":\"a}}b\",\"event\":0}}");
}

TEST(PropertyPages, EventsOfAViewNeverGoBackWhateverComesAndGoes) {
  std::mt19937 random(3);
  Pages pages;
  const auto page = std::make_shared<Recorder>();
  const int id = pages.join(page, "");
  std::vector<FrameMessage> delayed;
  std::array<std::uint32_t, kViewCount> last{};
  std::size_t seen = 0;
  for (std::uint64_t n = 1; n <= 10000; ++n) {
    pages.note(id, n, std::uint32_t(n));
    FrameMessage next = frame(pages, n, int(random() % kViewCount));
    if (random() % 3 == 0) {
      delayed.push_back(std::move(next));
    } else {
      pages.publish(std::move(next));
    }
    if (!delayed.empty() && random() % 3 == 0) {
      pages.publish(std::move(delayed.back()));
      delayed.pop_back();
    }
    if (random() % 2 == 0 && !page->frames.empty()) {
      const std::size_t back = std::min<std::size_t>(page->frames.size(), 1 + random() % 2);
      pages.acknowledge(id, page->frames[page->frames.size() - back].number);
    }
    for (; seen < page->frames.size(); ++seen) {
      const Sent& sent = page->frames[seen];
      ASSERT_EQ(sent.event, sent.frame->number);
      ASSERT_GE(sent.event, last[std::size_t(sent.frame->view)]);
      last[std::size_t(sent.frame->view)] = sent.event;
    }
  }
  EXPECT_GT(seen, 1000u);
}
