// Who may speak to the viewer, and which files a page may name.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"
#include "tools/viewer/folders.h"
#include "tools/viewer/gatekeeper.h"
#include "volumes/base/error.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

const std::string kToken(32, 'a');

}  // namespace

TEST(UnitGatekeeper, OnlyNamesOfTheLoopbackWithThePortAreHosts) {
  const Gatekeeper gate(8080, kToken);
  for (const char* own : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080"}) {
    EXPECT_TRUE(gate.is_own_host(own)) << own;
    EXPECT_TRUE(gate.is_own_origin(std::string("http://") + own)) << own;
  }
  for (const char* foreign :
       {"", "localhost", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:80800", "localhost:8080.evil.org",
        "evil.org:8080", "localhost.evil.org:8080", "127.0.0.2:8080", "0.0.0.0:8080", "[::]:8080",
        "::1:8080", "LOCALHOST:8080 ", "user@localhost:8080", "localhost:8080/",
        "localhost:8080,x"}) {
    EXPECT_FALSE(gate.is_own_host(foreign)) << foreign;
    EXPECT_FALSE(gate.is_own_origin(std::string("http://") + foreign)) << foreign;
  }
}

TEST(UnitGatekeeper, AnOriginIsThePagesOrNone) {
  const Gatekeeper gate(8080, kToken);
  EXPECT_TRUE(gate.is_own_origin(""));
  for (const char* foreign : {"null", "https://localhost:8080", "file://", "http:/localhost:8080",
                              "http://http://localhost:8080", "ws://localhost:8080"}) {
    EXPECT_FALSE(gate.is_own_origin(foreign)) << foreign;
  }
}

TEST(UnitGatekeeper, OtherOriginsAndAddressesAreOwnWhereTheyAreGiven) {
  const Gatekeeper gate(8080, kToken, {"https://hub.example", "http://localhost:9000"}, "10.0.0.7");
  for (const char* own : {"hub.example", "localhost:9000", "10.0.0.7:8080", "127.0.0.1:8080"}) {
    EXPECT_TRUE(gate.is_own_host(own)) << own;
  }
  for (const char* own : {"https://hub.example", "http://localhost:9000", "http://10.0.0.7:8080",
                          "http://localhost:8080"}) {
    EXPECT_TRUE(gate.is_own_origin(own)) << own;
  }
  for (const char* foreign :
       {"http://hub.example", "https://hub.example:8080", "null", "https://evil.hub.example",
        "https://hub.example.evil.org", "https://localhost:9000", "http://10.0.0.8:8080"}) {
    EXPECT_FALSE(gate.is_own_origin(foreign)) << foreign;
  }
  EXPECT_FALSE(gate.is_own_host("hub.example:8080"));
  EXPECT_FALSE(gate.is_own_host("localhost:9001"));
}

TEST(UnitGatekeeper, ARefusalSaysWhatWasFoundAndWhichOptionHelps) {
  const Gatekeeper gate(8080, kToken);
  const std::string forwarded = gate.refusal("localhost:9000", "");
  for (const char* words : {"host found:    localhost:9000\n", "127.0.0.1:8080",
                            "--origin http://localhost:9000\n", "--base-path"}) {
    EXPECT_NE(forwarded.find(words), std::string::npos) << forwarded;
  }
  const std::string proxied = gate.refusal("localhost:8080", "https://hub.example");
  EXPECT_NE(proxied.find("--origin https://hub.example\n"), std::string::npos) << proxied;
  for (const std::string& odd : {std::string("a b"), std::string("x\x01"), std::string(200, 'x')}) {
    const std::string text = gate.refusal(odd, odd);
    EXPECT_EQ(text.find(odd), std::string::npos);
    EXPECT_EQ(text.find(kToken), std::string::npos);
  }
}

TEST(UnitGatekeeper, OriginsAndBasePathsArePlain) {
  EXPECT_EQ(plain_origin("https://hub.example/"), "https://hub.example");
  EXPECT_EQ(plain_origin("https://hub.example:443"), "https://hub.example");
  EXPECT_EQ(plain_origin("http://localhost:9000"), "http://localhost:9000");
  for (const char* wrong :
       {"", "hub.example", "ftp://hub.example", "https://", "https://HUB.example",
        "https://hub.example/path", "https://user@hub.example", "https://a b"}) {
    EXPECT_THROW(plain_origin(wrong), InputError) << wrong;
  }
  EXPECT_EQ(plain_base_path("/user/me/proxy/8080"), "/user/me/proxy/8080/");
  EXPECT_EQ(plain_base_path("/"), "/");
  for (const char* wrong : {"", "proxy", "//evil.example", "/a b/", "/a\n", "/a?b"}) {
    EXPECT_THROW(plain_base_path(wrong), InputError) << wrong;
  }
}

TEST(UnitGatekeeper, TheTokenMustBeThereWhole) {
  const Gatekeeper gate(1, kToken);
  EXPECT_TRUE(gate.has_token("supple." + kToken));
  EXPECT_TRUE(gate.has_token("chat,\t supple." + kToken + " ,other"));
  for (const std::string& wrong :
       {std::string(), std::string("supple."), "supple." + kToken.substr(1),
        "supple." + kToken + "a", "Supple." + kToken, kToken, "supple. " + kToken,
        "supple." + std::string(32, 'b'), std::string(1000, ','), "supple." + kToken + "\n"}) {
    EXPECT_FALSE(gate.has_token(wrong)) << wrong;
  }
}

TEST(UnitGatekeeper, TokensDifferAndOneOfAFileIsKeptAwayFromOthers) {
  EXPECT_EQ(make_token().size(), 32u);
  EXPECT_NE(make_token(), make_token());
  const TemporaryFolder folder;
  const std::string path = folder / "token";
  const std::string token = token_of_file(path);
  EXPECT_EQ(token_of_file(path), token);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  EXPECT_THROW(token_of_file(path), InputError);
  ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
  std::ofstream(path) << "short";
  EXPECT_THROW(token_of_file(path), InputError);
}

class UnitFolders : public ::testing::Test {
 protected:
  UnitFolders() {
    std::filesystem::create_directories(m_outside / "in/below");
    std::filesystem::create_directory(m_outside / "in_too");
    for (const char* name : {"secret", "in_too/file", "in/file", "in/below/deep"}) {
      std::ofstream(m_outside / name) << name;
    }
    std::filesystem::create_symlink(m_outside / "secret", m_outside / "in/leads_out");
    std::filesystem::create_symlink(m_outside / "in/file", m_outside / "in/leads_in");
    std::filesystem::create_directory_symlink("..", m_outside / "in/up");
  }
  std::string at(const std::string& name) const { return m_outside / name; }

  TemporaryFolder m_outside;
};

TEST_F(UnitFolders, FilesBelowAreFoundWithoutLinks) {
  const Folders folders({at("in")});
  const std::string root = std::filesystem::canonical(at("in")).string();
  EXPECT_EQ(folders.input("file"), root + "/file");
  EXPECT_EQ(folders.input("below/../file"), root + "/file");
  EXPECT_EQ(folders.input(at("in/below/deep")), root + "/below/deep");
  EXPECT_EQ(folders.input("leads_in"), root + "/file");
  EXPECT_EQ(folders.input(root), root);
  EXPECT_EQ(folders.output("below/new.vdb"), root + "/below/new.vdb");
  EXPECT_EQ(folders.output("file"), root + "/file");
}

TEST_F(UnitFolders, NothingElseIsReadOrWritten) {
  const Folders folders({at("in")});
  for (const std::string& path :
       {std::string(), std::string("../secret"), at("secret"), std::string("leads_out"),
        std::string("up/secret"), std::string("/etc/passwd"), std::string("missing"),
        std::string("below/../../secret"), std::string("file\0.png", 9), std::string("file\n"),
        at("in_too/file"), at("in_too"), std::string(5000, 'a'), std::string(".."),
        std::string("/")}) {
    EXPECT_THROW(folders.input(path), InputError) << path;
  }
  for (const std::string& path :
       {std::string(), std::string("."), std::string("below/"), std::string("leads_out"),
        std::string("leads_in"), std::string("../new"), std::string("up/new"),
        std::string("missing/new"), std::string("below"), at("new"), std::string("/tmp/new")}) {
    EXPECT_THROW(folders.output(path), InputError) << path;
  }
}

TEST_F(UnitFolders, WhatIsOutsideAndWhatIsMissingLookAlike) {
  const Folders folders({at("in")});
  const auto message = [&](const std::string& path) {
    try {
      folders.input(path);
    } catch (const InputError& error) {
      return error.problem().found + error.problem().expected;
    }
    return std::string("found");
  };
  EXPECT_EQ(message("../secret"), message("../nothing"));
}

TEST(UnitGatekeeper, OnlyPagesOfNamedOriginsMayShowThePageAndTheKeyLetsFilesIn) {
  const std::string token(32, 'a');
  EXPECT_FALSE(Gatekeeper(8080, token).may_embed("http://127.0.0.1:8080"));
  const Gatekeeper keeper(8080, token, {}, "", {"https://ward.example"});
  EXPECT_TRUE(keeper.may_embed("https://ward.example"));
  for (const char* other : {"", "null", "http://ward.example", "https://ward.example.evil",
                            "https://ward.example:8443", "http://127.0.0.1:8080"}) {
    EXPECT_FALSE(keeper.may_embed(other)) << other;
  }
  EXPECT_FALSE(keeper.is_own_origin("https://ward.example"));
  EXPECT_TRUE(keeper.is_authorized("Bearer " + token));
  for (const std::string& other : {std::string(), token, "bearer " + token, "Bearer " + token + "a",
                                   "Bearer " + std::string(32, 'b')}) {
    EXPECT_FALSE(keeper.is_authorized(other)) << other;
  }
}
