"""Command lines: one clear line for a wrong one, the nearest match for a misspelt word, the house's exit codes."""

import argparse
import difflib
import os
import sys
import time

from pelorus_tools import __version__

DONE = 0         # did what was asked
MISSED = 1       # ran, but a limit given to it was missed
USAGE = 2        # wrong usage
UNREADABLE = 3   # input could not be read at all
PARTLY = 4       # input readable, but parts of it were refused (and counted by cause)


class UsageError(Exception):
    """The command line makes no sense; str() is the one line that says why."""


class UnreadableError(Exception):
    """The input cannot be used; str() is the one line that says why."""


def nearest(word, known):
    """' (did you mean ...?)' for the known word nearest to this one, or ''."""
    match = difflib.get_close_matches(word, list(known), n=1, cutoff=0.5)
    return f" (did you mean '{match[0]}'?)" if match else ""


class Parser(argparse.ArgumentParser):
    """argparse that raises UsageError, names the nearest option, and knows --version, -v and -q."""

    def __init__(self, **kwargs):
        super().__init__(allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter, **kwargs)
        self.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
        self.add_argument("-v", "--verbose", action="store_true", help="say more on standard error")
        self.add_argument("-q", "--quiet", action="store_true", help="say nothing but errors on standard error")

    def error(self, message):
        raise UsageError(message)

    def parse_args(self, args=None, namespace=None):
        args = sys.argv[1:] if args is None else list(args)
        known = [s for action in self._actions for s in action.option_strings]
        for word in args:
            if word == "--":
                break
            name = word.split("=", 1)[0]
            if name.startswith("--") and name not in known:
                raise UsageError(f"unknown option '{name}'{nearest(name, known)}")
        return super().parse_args(args, namespace)


class Progress:
    """A bar on standard error, only on a terminal and only when the work takes more than two seconds."""

    def __init__(self, what, quiet=False):
        self.what, self.start, self.drawn = what, time.monotonic(), 0.0
        self.live = sys.stderr.isatty() and not quiet
        self.shown = False

    def __call__(self, fraction):
        now = time.monotonic()
        if not self.live or now - self.start < 2.0 or now - self.drawn < 0.1:
            return
        n = int(30 * min(max(fraction, 0.0), 1.0))
        sys.stderr.write(f"\r{self.what} [{'#' * n}{'.' * (30 - n)}] {100 * fraction:3.0f} %")
        sys.stderr.flush()
        self.drawn, self.shown = now, True

    def done(self):
        if self.shown:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()


def run(prog, body, argv):
    """Call body(argv) and turn what it raises into one line and an exit code."""
    try:
        return body(argv)
    except UsageError as e:
        print(f"{prog}: {e}", file=sys.stderr)
        return USAGE
    except (UnreadableError, FileNotFoundError, IsADirectoryError, PermissionError) as e:
        text = f"{e.filename}: {e.strerror}" if isinstance(e, OSError) else str(e)
        print(f"{prog}: {text}", file=sys.stderr)
        return UNREADABLE
    except BrokenPipeError:
        # The reader of our standard output went away (head, less): that is its right, and no error of ours.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except KeyboardInterrupt:
        return 130
