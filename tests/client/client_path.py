"""Makes `import scree_client` find the client of this source tree."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "client" / "golden"
sys.path.insert(0, str(ROOT / "client"))
sys.dont_write_bytecode = True


def golden(name):
    lines = (GOLDEN / f"{name}.hex").read_text().splitlines()
    return bytes.fromhex("".join(line for line in lines if not line.startswith("#")))
