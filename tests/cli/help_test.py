# SPDX-License-Identifier: Apache-2.0
"""Proves that help and version say what they should where a new user looks for it."""
import re

from program import ProgramTest, main, run

COMMANDS = ["demo", "simulate", "convert", "export", "pack", "info", "compare", "farfield", "probe", "render", "view", "bench", "devices", "preview", "capture", "lab",
            "help"]


class Help(ProgramTest):
    def test_version(self):
        self.assertRegex(self.done("--version").stdout, r"^nearfield \d+\.\d+\.\d+\n$")

    def test_without_a_command_help_is_shown_and_the_exit_code_is_that_of_a_wrong_call(self):
        result = run()
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("nearfield demo -o out", result.stderr)

    def test_names_every_command_and_the_exit_codes(self):
        for arguments in (["help"], ["--help"]):
            text = self.done(*arguments).stdout
            for command in COMMANDS:
                self.assertIn(f"\n  {command} ", text)
            self.assertIn("Exit codes: 0 done, 1 error, 2 usage, 3", text)

    def test_every_command_explains_itself(self):
        for command in COMMANDS:
            text = self.done("help", command).stdout
            self.assertIn(f"Usage: nearfield {command}", text)
            self.assertEqual(text, self.done(command, "--help").stdout)
            self.assertNotRegex(text, r"->\d|ENUM|\bTEXT\b.*\bTEXT\b")
            if command != "demo":
                self.assertRegex(text, rf"Examples:\n  nearfield {command}\b")

    def test_defaults_of_choices_are_shown(self):
        text = self.done("help", "render").stdout
        self.assertRegex(text, r"--tonemap filmic\|papers\s.*; default filmic")
        self.assertRegex(text, r"--width PX\s+pixels \(1 ... 16384\); default 640")

    def test_examples_name_options_that_exist(self):
        for command in COMMANDS:
            text = self.done("help", command).stdout
            options, _, examples = text.partition("Examples:")
            for option in re.findall(r"--[a-z-]+", examples):
                self.assertIn(option, options, command)


if __name__ == "__main__":
    main()
