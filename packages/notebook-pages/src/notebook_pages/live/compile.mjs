// node compile.mjs <pyodide.mjs> <compile_wheels.py> <folder>
// Runs the Python program in Pyodide, with the folder mounted as /wheels: byte code must come from
// the very Python that is to load it.
import { readFileSync } from "node:fs";
import { dirname } from "node:path";
import { pathToFileURL } from "node:url";

const [pyodide, program, folder] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(pyodide));
// Left to itself it finds its folder by the trace of an error, which a folder called "book (2)" leads astray.
const python = await loadPyodide({ indexURL: dirname(pyodide) });
python.mountNodeFS("/wheels", folder);
python.runPython(readFileSync(program, "utf8"), { filename: program });
