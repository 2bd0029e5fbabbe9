# Formula of Homebrew for a tap. packaging/formula.py fills in what stands between @ signs.
class Vibro < Formula
  desc "Measurements of impacting machines, each with its uncertainty"
  homepage "@repository@"
  version "@version@"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "@repository@/releases/download/v@version@/vibro-@version@-aarch64-apple-darwin.tar.gz"
      sha256 "@aarch64-apple-darwin@"
    end
    on_intel do
      url "@repository@/releases/download/v@version@/vibro-@version@-x86_64-apple-darwin.tar.gz"
      sha256 "@x86_64-apple-darwin@"
    end
  end

  on_linux do
    on_arm do
      url "@repository@/releases/download/v@version@/vibro-@version@-aarch64-unknown-linux-musl.tar.gz"
      sha256 "@aarch64-unknown-linux-musl@"
    end
    on_intel do
      url "@repository@/releases/download/v@version@/vibro-@version@-x86_64-unknown-linux-musl.tar.gz"
      sha256 "@x86_64-unknown-linux-musl@"
    end
  end

  def install
    bin.install "vibro"
    man1.install "man/vibro.1"
    bash_completion.install "completions/vibro.bash" => "vibro"
    zsh_completion.install "completions/_vibro"
    fish_completion.install "completions/vibro.fish"
  end

  test do
    system bin/"vibro", "demo", "bench"
    assert_path_exists testpath/"bench/results/report.html"
  end
end
