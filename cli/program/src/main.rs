//! The `onescan` program.

fn main() -> std::process::ExitCode {
    onescan::cli::main()
}
