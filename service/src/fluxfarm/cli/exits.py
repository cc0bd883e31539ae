"""How the command ends: its exit codes, each with a sentence, and the error that carries one."""

from enum import IntEnum


class Exit(IntEnum):
    """Exit codes of `fluxfarm`."""

    OK = 0
    JOB_FAILED = 1
    BAD_INPUT = 2
    UNREACHABLE = 3
    CANCELLED = 4
    INTERRUPTED = 130


EXIT_SENTENCES: dict[Exit, str] = {
    Exit.OK: "done",
    Exit.JOB_FAILED: "the job failed; its reason was printed",
    Exit.BAD_INPUT: "the command line, the scene's files or the request are wrong",
    Exit.UNREACHABLE: "the service cannot be reached or cannot start",
    Exit.CANCELLED: "somebody else cancelled or deleted the job",
    Exit.INTERRUPTED: "stopped with Ctrl-C; a job that this command started is cancelled",
}


class CommandError(Exception):
    """Ends the command with a message on standard error and an exit code."""

    def __init__(self, code: Exit, message: str) -> None:
        self.code = code
        super().__init__(message)
