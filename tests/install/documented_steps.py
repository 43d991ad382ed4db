"""The commands of a document: the lines of its ```sh blocks."""
import re
from dataclasses import dataclass, field


@dataclass
class Block:
    document: str
    line: int
    needs: str = ""  # what this machine has not: the block's first line is "# needs WHAT"
    commands: list = field(default_factory=list)

    def __str__(self):
        return f"{self.document}:{self.line}"


def blocks_of(name, text):
    blocks = []
    for match in re.finditer(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        lines = match.group(1).replace("\\\n", " ").splitlines()
        block = Block(name, text.count("\n", 0, match.start()) + 2)
        if lines and lines[0].startswith("# needs "):
            block.needs = lines.pop(0)[len("# needs "):]
        block.commands = [line for line in lines if line.strip() and not line.startswith("#")]
        blocks.append(block)
    return blocks
