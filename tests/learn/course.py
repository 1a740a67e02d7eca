#!/usr/bin/env python3
"""Works through one lesson as a student does, and checks what the program says to right and wrong answers.

  tests/learn/course.py PROGRAM LESSON [BUILD_FOLDER]

BUILD_FOLDER is that of the library, for the lesson in C++. Exit code 1 and one line per failure.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOLUTIONS = HERE / "solutions"
CODES = {"right": 0, "unusable": 3, "crashed": 4, "wrong": 5}
STUDENT = 17


class Course:
    def __init__(self, program, lesson, scratch):
        self.program, self.lesson, self.scratch = program, lesson, pathlib.Path(scratch)
        self.folder = self.scratch / "mine"
        self.problems = []
        self.kinds = set()

    def run(self, *words, cwd=None, code=0):
        done = subprocess.run([self.program, *map(str, words)], cwd=cwd or self.folder, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)
        if code is not None and done.returncode != code:
            self.problems.append(f"{words}: exit code {done.returncode}, expected {code}: {done.stderr.strip()}")
        return done

    def start(self, student, folder):
        self.run("learn", "start", self.lesson, "--student", student, "-o", folder, cwd=self.scratch)

    def check(self, expected, answer=None, finding=None, folder=None, student=None):
        """The kind that the program names must be one of `expected`."""
        folder = folder or self.folder
        if answer is not None:
            (folder / "answer.txt").write_text(f"{answer}\n")
        words = ["learn", "check", str(self.lesson), str(folder), "--json"] + (["--student", str(student)] if student else [])
        done = self.run(*words, cwd=self.scratch, code=None)
        expected = [expected] if isinstance(expected, str) else expected
        try:
            said = json.loads(done.stdout)
        except json.JSONDecodeError:
            self.problems.append(f"{expected}: no JSON: {done.stdout} {done.stderr}")
            return None
        if said.get("kind") not in expected:
            self.problems.append(f"{answer if answer is not None else folder}: kind {said.get('kind')}, expected {expected}: {said}")
        elif finding and said["finding"] != finding:
            self.problems.append(f"{answer}: {said['finding']}, expected {finding}")
        elif done.returncode != CODES[said["finding"]]:
            self.problems.append(f"{answer}: exit code {done.returncode} for {said['finding']}")
        elif said["kind"] != "right" and len(said["said"]) < 20:
            self.problems.append(f"{answer}: no hint: {said}")
        else:
            self.kinds.add(said["kind"])
        return said

    def solution(self, folder):
        if self.lesson == 2:
            self.run("run", "naive_wheel", "run.rawlog", "-o", "wheels", "-q", cwd=folder)
        if self.lesson == 7:
            self.run("graph", "optimise", "loop.g2o", "-o", "solved.g2o", "--robust", "local", cwd=folder)
            self.run("graph", "optimise", "loop.g2o", "-o", "fooled.g2o", "--robust", "none", "--local", cwd=folder)
        done = subprocess.run([sys.executable, SOLUTIONS / f"lesson{self.lesson:02}.py"], cwd=folder, capture_output=True,
                              text=True, env=dict(os.environ, PYTHONDONTWRITEBYTECODE="1"))
        if done.returncode:
            self.problems.append(f"solution: {done.stderr}")
            return {"answer": 0, "wrong": {}}
        return json.loads(done.stdout)

    def numbers(self):
        """Right answers of two students, and every wrong one that the solution knows how to make."""
        self.check("missing", finding="unusable")
        solved = self.solution(self.folder)
        right = solved["answer"]
        self.check("other_student", right, finding="unusable", student=STUDENT + 1)
        self.check("right", right)
        self.check(["wrong", *solved["wrong"]], 12345.678, finding="wrong")
        text = self.run("learn", "check", self.lesson, "--student", STUDENT, "--", right, cwd=self.scratch)
        if not text.stdout.startswith(f"lesson {self.lesson}: right: "):
            self.problems.append(f"said: {text.stdout}")
        # The others as a teacher sees them: a folder each. A wrong way may lead to the right number in some building, or to another
        # wrong one.
        answers = {"two": ("about two", ["not_a_number"]), "empty": ("", ["not_a_number"]),
                   "words": (f"{right:.3f} of them", ["not_a_number"])}
        for name, value in solved["wrong"].items():
            answers["hint_" + name] = (value, self.alike(name, value, solved))
        other = self.scratch / "other"
        self.start(STUDENT + 20, other)
        second = self.solution(other)["answer"]
        handed_in = self.scratch / "handed_in"
        for name, (value, _) in answers.items():
            shutil.copytree(self.folder, handed_in / name)
            (handed_in / name / "answer.txt").write_text(f"{value}\n")
        shutil.copytree(other, handed_in / "other")
        (handed_in / "other" / "answer.txt").write_text(f"{second}\n")
        answers["other"] = (second, ["right"])
        # Somebody else's material under one's own name.
        shutil.copytree(other, handed_in / "taken")
        for name in sorted(os.listdir(self.folder)):
            if name.endswith((".csv", ".g2o", ".rawlog")):
                shutil.copy(self.folder / name, handed_in / "taken" / name)
        answers["taken"] = (right, ["changed_material"])
        graded = self.run("learn", "grade", handed_in, "--json", "-q", cwd=self.scratch)
        for row in json.loads(graded.stdout)["rows"]:
            name = pathlib.Path(row["folder"]).name
            if row["kind"] not in answers[name][1]:
                self.problems.append(f"{name}: kind {row['kind']}, expected {answers[name][1]}: {row['found']}")
            elif row["kind"] != "right" and len(row["said"]) < 20:
                self.problems.append(f"{name}: no hint")
            self.kinds.add(row["kind"])

    def alike(self, name, value, solved):
        if isinstance(value, str):
            return [name]
        close = lambda a, b: abs(a - b) <= 0.03 * max(abs(a), abs(b)) + 1e-9
        names = [other for other, v in solved["wrong"].items() if not isinstance(v, str) and close(v, value)]
        tolerance = {1: 0.01, 2: 0.1 * abs(solved["answer"]), 3: 0.1, 5: 0.005}.get(self.lesson, 0.02 * abs(solved["answer"]) + 0.005)
        return names + (["right"] if abs(value - solved["answer"]) <= tolerance else [])

    def method(self):
        self.check("missing", finding="unusable")
        self.run("new", "method", "mine")
        source = self.folder / "mine" / "mine.py"
        template = source.read_text()
        solved = re.sub(r'def correct\(.*?return T_previous_current\n', lambda _: (SOLUTIONS / "lesson04_correct.py").read_text(),
                        template, flags=re.DOTALL)
        self.check("unchanged")

        def wrong(kind, new, finding="wrong", old="correct(before.points, scan.points, guess)"):
            text = template.replace(old, new)
            if text == template:
                self.problems.append(f"{kind}: '{old}' is not in the template")
            source.write_text(text)
            self.check(kind, finding=finding)

        wrong("crashed", "correct(before.points, scan.points)", "crashed")
        wrong("contract", 'open(output_path + ".txt", "w"', old='open(output_path, "w"')
        wrong("backwards", "between(guess, (0.0, 0.0, 0.0))")
        wrong("centimetres", "(100 * guess[0], 100 * guess[1], guess[2])")
        wrong("degrees", "(guess[0], guess[1], math.degrees(guess[2]))")
        wrong("turned_round", "(guess[0], guess[1], -guess[2])")
        wrong("wrong", "(guess[0], guess[1] + 0.02, guess[2])")
        source.write_text(solved)
        self.check("right")
        tests = subprocess.run([sys.executable, "-B", "-m", "unittest", "discover", "-s", "mine"], cwd=self.folder,
                               capture_output=True, text=True)
        if tests.returncode:
            self.problems.append(f"the template's tests with the solution: {tests.stderr}")

    def strategy(self, library):
        self.check("missing", finding="unusable")
        self.run("new", "strategy", "mine")
        self.check("not_built", finding="unusable")
        source = self.folder / "mine" / "mine.cpp"
        template = source.read_text()
        chosen = (SOLUTIONS / "lesson09_choose.cpp").read_text()
        body = r"std::optional<Mine::Choice> Mine::choose\(.*?\n}\n"
        solved = "#include <cmath>\n\n" + re.sub(body, lambda _: chosen, template, flags=re.DOTALL)
        # One program for all answers: which it is says a file.
        nearest = chosen.replace("worth > most", "i == 0")
        nothing = "return std::nullopt;"
        variants = {"solved": re.search(r"\{\n(.*)\n}\n", chosen, re.DOTALL).group(1),
                    "nearest": re.search(r"\{\n(.*)\n}\n", nearest, re.DOTALL).group(1),
                    "template": re.search(body, template, re.DOTALL).group(0).split("{\n", 1)[1].rsplit("}\n", 1)[0],
                    "nothing": nothing, "crash": 'throw std::runtime_error("I am lost");'}
        choose = "".join(f'  if (answer() == "{name}") {{\n{text}\n  }}\n' for name, text in variants.items())
        asking = ('#include <fstream>\n#include <stdexcept>\nstatic std::string answer() {\n  std::ifstream in("'
                  + str(self.scratch / "answer") + '");\n  std::string word;\n  in >> word;\n  return word;\n}\n')
        text = re.sub(body, lambda _: "std::optional<Mine::Choice> Mine::choose(const slam::strategies::Prospects& prospects) {\n" + choose
                      + "  return std::nullopt;\n}\n", template, flags=re.DOTALL)
        source.write_text(text.replace('#include "mine.h"\n', '#include "mine.h"\n\n#include <cmath>\n' + asking))
        answer = self.scratch / "answer"
        answer.write_text("solved")
        commands = [["cmake", "-S", "mine", "-B", "mine/build", f"-DRASTERSLAM={library}", "-DCMAKE_CXX_FLAGS_RELEASE=-O1"],
                    ["cmake", "--build", "mine/build"]]
        for command in commands:
            done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
            if done.returncode:
                self.problems.append(f"{command}: {done.stdout[-2000:]} {done.stderr[-2000:]}")
                return
        self.check("right")
        for word, kind in {"nearest": "same_as_nearest", "template": "unchanged", "nothing": "stuck"}.items():
            answer.write_text(word)
            self.check(kind, finding="wrong")
        answer.write_text("crash")
        self.check("crashed", finding="crashed")

    def sweep(self):
        self.check("missing", finding="unusable")
        first = STUDENT * 100 + 1
        suite = (SOLUTIONS / "lesson10_fair.ini").read_text().replace("FIRST", str(first)).replace("LAST", str(first + 7))

        def bench(text):
            shutil.rmtree(self.folder / "fair", ignore_errors=True)
            (self.folder / "fair.ini").write_text(text)
            self.run("bench", "fair.ini", "-o", "fair", "-q")

        quick = suite.replace("simulation]\nduration_s = 10", "simulation]\nduration_s = 1")
        bench(quick.replace("flat:seed=12:width_m=14:height_m=10", "plan.yaml"))
        self.check("world_not_held_out", finding="wrong")
        bench(quick.replace(f"{first}..{first + 7}", f"{first}..{first + 2}"))
        self.check("too_few_seeds", finding="wrong")
        bench(quick.replace(f"{first}..{first + 7}", "1..2"))
        self.check("other_student", finding="unusable")
        bench(quick.replace("naive_flow, naive_correlation", "naive_flow, naive_wheel"))
        self.check("not_both", finding="wrong")
        bench(suite)
        self.check("not_a_verdict", finding="unusable")
        self.check("not_a_verdict", "yes", finding="unusable")
        words = ["better", "worse", "no difference"]
        kinds = [self.check(["right", "not_significant", "overlooked", "wrong_way"], word)["kind"] for word in words]
        if kinds.count("right") != 1:
            self.problems.append(f"{dict(zip(words, kinds))}: expected one to be right")
        cell = sorted((self.folder / "fair" / "cells").iterdir())
        for folder in cell:
            shutil.rmtree(folder)
        self.check("incomplete", finding="wrong")


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    lesson = int(sys.argv[2])
    with tempfile.TemporaryDirectory() as scratch:
        course = Course(str(pathlib.Path(sys.argv[1]).resolve()), lesson, scratch)
        course.start(STUDENT, course.folder)
        if lesson == 4:
            course.method()
        elif lesson == 9:
            course.strategy(pathlib.Path(sys.argv[3]).resolve())
        elif lesson == 10:
            course.sweep()
        else:
            course.numbers()
        page = course.run("learn", lesson, cwd=scratch).stdout
        if max(map(len, page.splitlines())) > 100 or len(page) < 1500:
            course.problems.append("the page in the terminal is too wide, or empty")
        wrong = course.kinds - {"right"}
        if len(wrong) < 5:
            course.problems.append(f"only {sorted(wrong)}: fewer than five kinds of wrong answers got their hint")
    print(f"lesson {lesson}: {len(course.kinds)} kinds of answer: {', '.join(sorted(course.kinds))}")
    sys.exit("\n".join(course.problems) if course.problems else 0)


if __name__ == "__main__":
    main()
