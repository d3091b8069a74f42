"""BIF and XMLBIF as other programs and people write them: the right answer, or one line that says what is wrong."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from network_cases import ANSWER, BIF, XML, check_answer, refusal

import bayeshunt as bh

JAVABAYES = """// Bayesian network in the interchange format
network "Small-Network" { //4 variables and 4 probability distributions
\tproperty "author, of {this}" ;
}
variable  "Gait" { //2 values
\ttype discrete[2] {  "go"  "turn" };
\tproperty "position = (218, 195)" ;
}
variable  "Distance" { type discrete[2] {  "0-10 mm"  "10-20 mm" }; }
variable  "Angle" { type discrete[2] {  "180 deg"  "0 deg" }; }
variable  "Heading" { type discrete[2] {  "180 deg"  "0 deg" }; }
probability (  "Gait" ) { //1 variable(s) and 2 values
\ttable
\t\t0.25
\t\t0.75 ;
}
probability (  "Distance"  "Gait" ) { //2 variable(s) and 4 values
\ttable
\t\t0.2 0.9
\t\t0.8 0.1 ;
}
probability (  "Angle"  "Gait" ) { table 0.3 0.6 0.7 0.4 ; }
probability (  "Heading"  "Gait" ) { table 0.5 0.1 0.5 0.9 ; }
"""

SAME_BIF = {
    "as it is": BIF,
    "no newline at the end": BIF.rstrip(),
    "line ends of Windows": BIF.replace("\n", "\r\n"),
    "line ends of old": BIF.replace("\n", "\r"),
    "byte order mark": "\ufeff" + BIF,
    "blanks after braces": BIF.replace("{\n", "{ \t\n").replace("}\n", "} \n"),
    "blanks at the end": BIF + " \n\n\t",
    "one line": BIF.replace("\n", " "),
    "no blanks": re.sub(r" ?([{}()|;,]) ?", r"\1", BIF).replace("\n", ""),
    "tabs": BIF.replace("  ", "\t"),
    "name variable_speed": BIF.replace("small", "variable_speed"),
    "name variable x": BIF.replace("small", "variable x"),
    "name probability": BIF.replace("small", "probability"),
    "quoted name": BIF.replace("small", '"a { strange } name; with all"'),
    "no name": BIF.replace(" small", ""),
    "no header": BIF.removeprefix("network small {\n}\n"),
    "quoted states": BIF.replace("go", '"go"').replace("0 deg", '"0 deg"').replace('18"0 deg"', '"180 deg"'),
    "quoted variables": BIF.replace("Gait", '"Gait"').replace("Angle", '"Angle"'),
    "default first": BIF.replace("(go) 0.3, 0.7;\n  (turn) 0.6, 0.4", "default 0.3, 0.7;\n  (turn) 0.6, 0.4"),
    "default last": BIF.replace("(turn) 0.6, 0.4", "default 0.6, 0.4"),
    "default unused": BIF.replace("(turn) 0.6, 0.4;", "(turn) 0.6, 0.4; default 0.5, 0.5;"),
    "default of one without parents": BIF.replace("table 0.25, 0.75", "default 0.25, 0.75"),
    "table of all": BIF.replace("(go) 0.3, 0.7;\n  (turn) 0.6, 0.4", "table 0.3, 0.6, 0.7, 0.4"),
    "no commas": BIF.replace("0.3, 0.7", "0.3 0.7").replace("0.25, 0.75", "0.25 0.75").replace("go, turn", "go turn"),
    "comments": BIF.replace(";", "; // {(,\n/* not ; \n this } */").replace("0.25,", "0.25/* a */, // b\n"),
    "properties": BIF.replace("{\n", "{\n  property weight = None ;\n  property it's { or ( not\u00e9 ;\n"),
    "properties last": BIF.replace(";\n}", ";\n  property x\n y;\n}"),
    "other forms of numbers": BIF.replace("0.25, 0.75", "2.5e-1, +.75").replace("0.3, 0.7", "3E-1, 0.70000"),
    "states in another order": BIF.replace("{ 180 deg, 0 deg }", "{ 0 deg, 180 deg }")
    .replace("0.3, 0.7", "0.7, 0.3").replace("0.6, 0.4", "0.4, 0.6").replace("0.1, 0.9", "0.9, 0.1").replace(
        "  (turn) 0.9, 0.1;\n}\nprobability ( Angle", "  (turn) 0.9, 0.1;\n}\nprobability ( Angle"),
    "rows in another order": BIF.replace("(go) 0.2, 0.8;\n  (turn) 0.9, 0.1;", "(turn) 0.9, 0.1;\n  (go) 0.2, 0.8;"),
    "tables before variables": BIF[BIF.index("probability") :] + BIF[: BIF.index("probability")].split("}\n", 1)[1],
    "number of states left out": BIF.replace("[ 2 ] ", ""),
    "JavaBayes": JAVABAYES,
}  # fmt: skip


@pytest.mark.parametrize("text", SAME_BIF.values(), ids=SAME_BIF)
def test_every_way_to_write_a_bif_gives_the_same_answer(text: str, tmp_path: Path) -> None:
    (tmp_path / "net.bif").write_bytes(text.encode())
    check_answer(tmp_path / "net.bif")


NAMES = [
    "go, fast", "go (fast)", "go [fast]", "go {fast}", 'go "fast"', "go's", "go; fast", "go | fast", "a//b", "/* a */",
    "gehe \u00fcber \u4e16", "table", "default", "property", "type", "g" * 300, "1", "0.5", "(go", "\\", "<go>",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_any_name_of_a_state_can_be_quoted(name: str, tmp_path: Path) -> None:
    quoted = '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
    text = BIF.replace("{ go,", f"{{ {quoted},").replace("(go)", f"({quoted})")
    (tmp_path / "net.bif").write_bytes(text.encode())
    check_answer(tmp_path / "net.bif", (name, "turn"))


@pytest.mark.parametrize(
    "name", ["go (fast)", "go [fast]", "go {fast}", "go's", "go/fast", 'go"fast', "go  (a, b)", "[go]"]
)
def test_names_that_need_no_quotes(name: str, tmp_path: Path) -> None:
    text = BIF.replace("{ go,", f"{{ {name},").replace("(go)", f"({name})")
    (tmp_path / "net.bif").write_bytes(text.encode())
    check_answer(tmp_path / "net.bif", (" ".join(name.split()), "turn"))


WRONG_BIF = {
    "no table": (BIF[: BIF.rindex("probability")], ", line 12: variable Heading has no table"),
    "empty table": (
        BIF.replace("  (go) 0.5, 0.5;\n  (turn) 0.1, 0.9;\n", ""), ", line 26: table of Heading: no row (go)"
    ),
    "empty table of a root": (BIF.replace("  table 0.25, 0.75;\n", ""), ", line 15: Gait has no table"),
    "a row twice": (
        BIF.replace("(turn) 0.6, 0.4;", "(turn) 0.6, 0.4;\n  (turn) 0.5, 0.5;"),
        ", line 25: table of Angle: row (turn) is given twice (first on line 24)",
    ),
    "the same row twice": (
        BIF.replace("(go) 0.3, 0.7;", "(go) 0.3, 0.7;" * 2),
        ", line 23: table of Angle: row (go) is given twice (first on line 23)",
    ),
    "default twice": (
        BIF.replace("(go) 0.3, 0.7;", "default 0.3, 0.7; default 0.2, 0.8;"),
        ", line 23: table of Angle: the default row is given twice (first on line 23)",
    ),
    "a missing row": (BIF.replace("  (turn) 0.6, 0.4;\n", ""), ", line 22: table of Angle: no row (turn)"),
    "rows and table": (
        BIF.replace("(go) 0.3, 0.7;", "table 0.3, 0.6, 0.7, 0.4;"), ", line 24: table of Angle: both 'table' and rows"
    ),
    "two tables": (BIF.replace("0.75;", "0.75; table 0.5, 0.5;"), ", line 16: table of Gait: a second 'table'"),
    "too few": (
        BIF.replace("0.3, 0.7", "1"), ", line 23: table of Angle, row (go): 1 probabilities; expected 2"
    ),
    "too many": (BIF.replace("0.25, 0.75", "0.25, 0.7, 0.05"), ", line 15: table of Gait: 3 probabilities; expected 2"),
    "not 1": (
        BIF.replace("0.6, 0.4", "0.6, 0.5"), ", line 24: table of Angle (turn) is not a distribution: it sums to 1.1"
    ),
    "not 1, root": (
        BIF.replace("0.25, 0.75", "0.25, 0.7"), ", line 15: table of Gait is not a distribution: it sums to 0.95"
    ),
    "negative": (
        BIF.replace("0.3, 0.7", "-0.3, 1.3"), ", line 23: table of Angle, row (go): -0.3 is no probability"
    ),
    "not a number": (BIF.replace("0.3, 0.7", "nan, 0.7"), "table of Angle, row (go): nan is no probability"),
    "infinite": (BIF.replace("0.3, 0.7", "1e999, 0.7"), "table of Angle, row (go): inf is no probability"),
    "a word": (BIF.replace("0.3,", "x,"), ", line 23: table of Angle, row (go): expected a probability, got 'x'"),
    "underscore": (BIF.replace("0.3,", "0_3,"), "expected a probability, got '0_3'"),
    "a fraction": (BIF.replace("0.3,", "3/10,"), "expected a probability, got '3/10'"),
    "decimal commas": (BIF.replace("0.3, 0.7", "0,3, 0,7"), "row (go): 4 probabilities; expected 2"),
    "other decimal digits": (BIF.replace("0.3,", "\u0660.3,"), "expected a probability"),
    "unknown parent": (
        BIF.replace("( Angle | Gait )", "( Angle | Gate )"), ", line 22: table of Angle: parent 'Gate' is not declared"
    ),
    "unknown child": (BIF.replace("( Angle |", "( Angel |"), ", line 22: variable 'Angel' is not declared"),
    "unknown state": (
        BIF.replace("(turn) 0.6", "(tern) 0.6"),
        ", line 24: table of Angle, row (tern): Gait has no state 'tern'; it has go, turn",
    ),
    "too many states in a row": (
        BIF.replace("(turn) 0.6", "(turn, go, go) 0.6"), "Gait has no state 'turn, go, go'; it has go, turn"
    ),
    "parent twice": (
        BIF.replace("( Angle | Gait )", "( Angle | Gait, Gait )"), ": the parent Gait is named twice"
    ),
    "own parent": (BIF.replace("( Angle | Gait )", "( Angle | Angle )").replace("(go) 0.3", "(0 deg) 0.3").replace(
        "(turn) 0.6", "(180 deg) 0.6"), "the edges run in a circle: Angle -> Angle"),
    "a circle": (
        BIF.replace("( Gait ) {\n  table 0.25, 0.75;", "( Gait | Angle ) {\n  default 0.25, 0.75;"),
        "the edges run in a circle: ",
    ),
    "a variable twice": (
        BIF.replace("variable Heading {", "variable Angle {"),
        ", line 12: variable Angle is declared twice (first on line 9)",
    ),
    "a table twice": (
        BIF + BIF[BIF.index("probability ( Gait") : BIF.index("probability ( Dist")],
        ", line 30: the table of Gait is given twice (first on line 15)",
    ),
    "a state twice": (BIF.replace("{ go, turn }", "{ go, go }"), ", line 3: variable Gait: the state 'go' is named"),
    "more states than said": (
        BIF.replace("{ go, turn }", "{ go, fast, turn }"),
        ", line 4: variable Gait: 2 states are declared and 3 listed (go, fast, turn); names that hold commas need q",
    ),
    "fewer states": (BIF.replace("{ go, turn }", "{ go }"), ", line 4: variable Gait: 2 states are declared and 1 li"),
    "no type": (BIF.replace("  type discrete [ 2 ] { go, turn };\n", ""), ", line 3: variable Gait has no type"),
    "continuous": (BIF.replace("discrete [ 2 ] { go", "continuous [ 2 ] { go"), "variable Gait: expected 'discrete'"),
    "no semicolon": (
        BIF.replace("0.2, 0.8;", "0.2, 0.8"), ", line 20: table of Distance, row (go): expected a probability or ';',"
    ),
    "no brace": (BIF.replace("}\nvariable Angle", "\nvariable Angle"), ", line 9: expected 'type', 'property' or '}"),
    "two networks": (BIF + BIF, ", line 30: expected one network, at the beginning"),
    "the end is missing": (BIF.rstrip().rstrip("}"), ", line 29: the file ends within the probability that begins on"),
    "half": (BIF[: len(BIF) // 2], ", line 13: the file ends within the variable that begins on line 12"),
    "empty": ("", ": holds no network (the file is empty)"),
    "blank": (" \n\t\n", ": holds no network (the file is empty)"),
    "byte order mark alone": ("\ufeff", ": holds no network (the file is empty)"),
    "only a header": ("network x {\n}\n", ": holds no network (no variable is declared)"),
    "other variables": (
        BIF.replace("Angle", "Bearing"), ": the variables are Bearing, Distance, Gait, Heading; expected exactly Gait"
    ),
    "HTML": ("<!DOCTYPE html>\n<html><body>Not found</body></html>", ", line 1: expected 'network', 'variable' or '"),
    "XML": (XML, ", line 1: expected 'network', 'variable' or 'probability', got '<?xml'"),
    "zeros": ("\0" * 500, ", line 1: expected 'network', 'variable' or 'probability', got"),
    "a huge table": (
        BIF.replace("[ 2 ] { go, turn }", f"[ 5000 ] {{ {' '.join(f'g{i}' for i in range(5000))} }}").replace(
            "[ 2 ] { 180 deg, 0 deg };\n}\nvariable Heading",
            f"[ 5000 ] {{ {' '.join(map(str, range(5000)))} }};\n}}\nvariable Heading",
        ),
        "cells; the most is 16,777,216",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("text", "says"), WRONG_BIF.values(), ids=WRONG_BIF)
def test_a_wrong_bif_is_refused_in_one_line(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "net.bif").write_bytes(text.encode())
    assert says in refusal(tmp_path / "net.bif")


def test_many_variables_are_not_listed_all(tmp_path: Path) -> None:
    more = "".join(
        f"variable V{i:03d} {{ type discrete [ 1 ] {{ x }}; }}\nprobability ( V{i:03d} ) {{ table 1; }}\n"
        for i in range(409)
    )
    (tmp_path / "net.bif").write_text(BIF + more)
    said = refusal(tmp_path / "net.bif")
    assert said == (
        ": the variables are Angle, Distance, Gait, Heading, V000 and 408 more; "
        "expected exactly Gait, Distance, Angle, Heading (and perhaps PreviousGait, Energy)"
    )


@pytest.mark.parametrize("ending", ["bif", "xml"])
@pytest.mark.parametrize(
    "data", [b"\x80\x04\x95\x10\x00\x00\x00\x8c", bytes(range(256)), b"\x89PNG\r\n\x1a\n\0\0", BIF.encode("utf-16")]
)
def test_what_is_no_text_is_refused(ending: str, data: bytes, tmp_path: Path) -> None:
    (tmp_path / f"net.{ending}").write_bytes(data)
    assert f"not a readable {'BIF' if ending == 'bif' else 'XMLBIF'} network" in refusal(tmp_path / f"net.{ending}")


def test_a_folder_is_no_network(tmp_path: Path) -> None:
    (tmp_path / "net.bif").mkdir()
    assert refusal(tmp_path / "net.bif") == ": is a folder"


# --- XMLBIF ----------------------------------------------------------------------------------------

DTD = """<!-- a comment -->
<!DOCTYPE BIF [
 <!ELEMENT BIF ( NETWORK )*>
       <!ATTLIST BIF VERSION CDATA #REQUIRED>
 <!ELEMENT NETWORK ( NAME, ( PROPERTY | VARIABLE | DEFINITION )* )>
 <!ELEMENT NAME (#PCDATA)>
]>
"""
SAME_XML = {
    "as it is": XML,
    "no newline at the end": XML.rstrip(),
    "no declaration": XML.split("\n", 1)[1],
    "a declared encoding": XML.replace('"1.0"', '"1.0" encoding="US-ASCII"'),
    "byte order mark": "\ufeff" + XML,
    "line ends of Windows": XML.replace("\n", "\r\n"),
    "blanks around names": re.sub(r"<(NAME|OUTCOME|FOR|GIVEN)>([^<]*)<", r"<\1>\n \2\t<", XML),
    "document type": XML.replace("<BIF", DTD + "<BIF"),
    "comments": XML.replace("<TABLE>", "<!-- { --><TABLE><!-- 0.5 -->").replace("0.8 0.9", "0.8 <!-- turn --> 0.9"),
    "properties": XML.replace("</NAME>", "</NAME><PROPERTY>position = (1, 2)</PROPERTY><PROPERTY/>").replace(
        "</FOR>", "</FOR><PROPERTY>x</PROPERTY>"),
    "indented": XML.replace("><", ">\n   <"),
    "commas": XML.replace("0.25 0.75", "0.25, 0.75"),
    "CDATA": XML.replace("<NAME>Gait</NAME>", "<NAME><![CDATA[Gait]]></NAME>"),
    "character references": XML.replace("<OUTCOME>go</OUTCOME>", "<OUTCOME>&#103;o</OUTCOME>"),
    "tables before variables": XML.replace(
        "<VARIABLE", "<DEFINITION><FOR>Gait</FOR><TABLE>0.25 0.75</TABLE></DEFINITION><VARIABLE", 1
    ).replace("<DEFINITION><FOR>Gait</FOR><TABLE>0.25 0.75</TABLE></DEFINITION>\n", ""),
    "what others add": XML.replace("</NAME>", "</NAME><XPOS>3</XPOS>"),
}  # fmt: skip


@pytest.mark.parametrize("text", SAME_XML.values(), ids=SAME_XML)
@pytest.mark.parametrize("ending", ["xml", "xmlbif", "bifxml"])
def test_every_way_to_write_an_xmlbif_gives_the_same_answer(text: str, ending: str, tmp_path: Path) -> None:
    (tmp_path / f"net.{ending}").write_bytes(text.encode())
    check_answer(tmp_path / f"net.{ending}")


@pytest.mark.parametrize("name", ["go, fast", "go (fast)", 'go "fast"', "&lt;go&gt;", "\u00fc\u4e16", "a//b", "table"])
def test_any_name_of_a_state_in_xml(name: str, tmp_path: Path) -> None:
    text = XML.replace("<OUTCOME>go</OUTCOME>", f"<OUTCOME>{name}</OUTCOME>")
    (tmp_path / "net.xml").write_bytes(text.encode())
    check_answer(tmp_path / "net.xml", (name.replace("&lt;", "<").replace("&gt;", ">"), "turn"))
    (tmp_path / "latin.xml").write_bytes(
        text.replace("\u4e16", "").replace('"1.0"', '"1.0" encoding="ISO-8859-1"').encode("latin-1")
    )
    check_answer(tmp_path / "latin.xml", (name.replace("&lt;", "<").replace("&gt;", ">").replace("\u4e16", ""), "turn"))


LAUGHS = '<!DOCTYPE BIF [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'
OUTSIDE = '<!DOCTYPE BIF [<!ENTITY a SYSTEM "file:///etc/hostname">]>'
ELSEWHERE = '<!DOCTYPE BIF SYSTEM "http://example.org/bif.dtd">'
HEADING = "<DEFINITION><FOR>Heading</FOR><GIVEN>Gait</GIVEN><TABLE>0.5 0.5 0.1 0.9</TABLE></DEFINITION>\n"
WRONG_XML = {
    "no table": (XML.replace(HEADING, ""), ", line 8: variable Heading has no table"),
    "a table twice": (XML.replace(HEADING, HEADING * 2), ", line 13: the table of Heading is given twice (first on "),
    "too few": (XML.replace("0.5 0.1 0.9", "0.5 0.1"), ", line 12: table of Heading: 3 probabilities; expected 4"),
    "not 1": (XML.replace("0.6 0.4", "0.6 0.5"), ", line 11: table of Angle (turn) is not a distribution: it sums t"),
    "negative": (XML.replace("0.3 0.7", "-0.3 1.3"), ", line 11: table of Angle: -0.3 is no probability"),
    "a word": (XML.replace("0.3 0.7", "x 0.7"), ", line 11: table of Angle: expected a probability, got 'x'"),
    "empty table": (XML.replace("0.25 0.75", ""), ", line 9: table of Gait: 0 probabilities; expected 2"),
    "unknown parent": (XML.replace("<GIVEN>Gait", "<GIVEN>Gate", 1), ", line 10: table of Distance: parent 'Gate' i"),
    "unknown child": (XML.replace("<FOR>Angle", "<FOR>Angel"), ", line 11: variable 'Angel' is not declared"),
    "a variable twice": (XML.replace("<NAME>Heading", "<NAME>Angle"), ", line 8: variable Angle is declared twice ("),
    "a state twice": (XML.replace(">turn<", ">go<"), ", line 5: variable Gait: the state 'go' is named twice"),
    "a nameless state": (XML.replace(">turn<", "><"), ", line 5: variable Gait: a state without a name"),
    "two names": (XML.replace("<NAME>Gait", "<NAME>x</NAME><NAME>Gait"), ", line 5: VARIABLE: expected one NAME, go"),
    "no states": (re.sub("<OUTCOME>(go|turn)</OUTCOME>", "", XML), ", line 5: variable Gait has no states"),
    "a circle": (
        XML.replace("<FOR>Gait</FOR><TABLE>0.25 0.75", "<FOR>Gait</FOR><GIVEN>Angle</GIVEN><TABLE>0.25 0.75 0.25 0.75"),
        "the edges run in a circle: ",
    ),
    "something strange": (XML.replace("<TABLE>0.25", "<DPIS/><TABLE>0.25"), ", line 9: table of Gait: the element D"),
    "something in the table": (XML.replace("0.25 0.75", "<E>0.25 0.75</E>"), "expected probabilities, got the eleme"),
    "no closing tag": (XML.replace("</NETWORK>", ""), ", line 14: not a readable XMLBIF network (it is not well-f"),
    "half": (XML[: len(XML) // 2], "not a readable XMLBIF network (it is not well-formed XML"),
    "empty": ("", ": holds no network (the file is empty)"),
    "byte order mark alone": ("\ufeff", ": holds no network (the file is empty)"),
    "no network": ("<BIF></BIF>", ", line 1: expected one NETWORK within BIF, got 0"),
    "two networks": ("<BIF><NETWORK/><NETWORK/></BIF>", ", line 1: expected one NETWORK within BIF, got 2"),
    "an empty network": ("<BIF><NETWORK/></BIF>", ": holds no network (no variable is declared)"),
    "other XML": ("<html><body/></html>", ", line 1: not a readable XMLBIF network: expected the element BIF, got h"),
    "BIF": (BIF, ", line 1: not a readable XMLBIF network (it is not well-formed XML"),
    "an entity": (LAUGHS + XML.split("\n", 1)[1].replace("small", "&b;"), "it declares or uses entities of its own"),
    "an outer entity": (OUTSIDE + XML.split("\n", 1)[1].replace("small", "&a;"), "it declares or uses entities of i"),
    "an entity from elsewhere": (
        ELSEWHERE + XML.split("\n", 1)[1].replace(">go<", ">g&b;o<"), "it declares or uses entities of its own"
    ),
    "an unknown encoding": (XML.replace('"1.0"', '"1.0" encoding="klingon"'), ", line 1: not a readable XMLBIF netw"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "says"), WRONG_XML.values(), ids=WRONG_XML)
def test_a_wrong_xmlbif_is_refused_in_one_line(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "net.xml").write_bytes(text.encode())
    assert says in refusal(tmp_path / "net.xml")


# --- label maps ------------------------------------------------------------------------------------


def labelled(folder: Path, labels: str) -> Path:
    (folder / "net.xml").write_text(XML.replace(">go<", ">g0<").replace(">turn<", ">g1<"))
    (folder / "net.xml.labels.json").write_bytes(labels.encode())
    return folder / "net.xml"


@pytest.mark.parametrize("before", ["", "\ufeff"])
def test_a_label_map_names_the_states(before: str, tmp_path: Path) -> None:
    labels = {"Gait": {"g0": "go", "g1": "turn"}, "Distance": {}, "Angle": {}, "Heading": {}}
    check_answer(labelled(tmp_path, before + json.dumps(labels)))


@pytest.mark.parametrize(
    ("gait", "says"),
    [
        ('{"g0": "go", "g1": "go"}', "contradicts itself: Gait: g0, g1 are all called 'go'"),
        ('{"g0": "g1"}', "contradicts itself: Gait: g0, g1 are all called 'g1'"),
        ('{"g0": "go", "g0": "turn", "g1": "x"}', "contradicts itself: g0 is there twice"),
        ("[]", "not a label map of"),
        ('"g0"', "not a label map of"),
    ],
)
def test_a_label_map_that_contradicts_itself_is_refused(gait: str, says: str, tmp_path: Path) -> None:
    path = labelled(tmp_path, f'{{"Gait": {gait}, "Distance": {{}}, "Angle": {{}}, "Heading": {{}}}}')
    said = refusal(path)
    assert said.startswith(f".labels.json: {says}")


# --- other programs --------------------------------------------------------------------------------


def test_pyagrum_reads_the_same_network(tmp_path: Path) -> None:
    gum = pytest.importorskip("pyagrum")
    (tmp_path / "net.bifxml").write_text(XML)
    engine = gum.LazyPropagation(gum.loadBN(str(tmp_path / "net.bifxml")))
    engine.setEvidence({"Distance": 0, "Angle": 1})
    engine.makeInference()
    np.testing.assert_allclose(engine.posterior("Gait").toarray(), ANSWER, atol=1e-12)


@pytest.mark.parametrize("ending", ["bif", "xml"])
def test_what_pgmpy_writes_comes_in(ending: str, tmp_path: Path) -> None:
    from pgmpy.readwrite import BIFWriter, XMLBIFWriter

    (tmp_path / "net.bif").write_text(BIF)
    model = check_answer(tmp_path / "net.bif")
    path = tmp_path / f"theirs.{ending}"
    if ending == "bif":
        path.write_text(str(BIFWriter(model.network)))
        check_answer(path)
    else:
        XMLBIFWriter(model.network).write_xmlbif(str(path))  # it puts "_" for blanks
        theirs = bh.import_network(path, gaits=model.gaits, axes=model.axes)
        np.testing.assert_allclose(theirs.probabilities("Heading"), model.probabilities("Heading"), atol=1e-12)


# --- damage ----------------------------------------------------------------------------------------


def damaged(text: bytes, rng: np.random.Generator) -> bytes:
    """The text with one to three faults, of the kinds that editors, disks and scripts make."""
    for _ in range(rng.integers(1, 4)):
        start, length = int(rng.integers(len(text) or 1)), int(rng.geometric(0.3))
        junk = bytes(rng.choice(list(b'{}()[],;|"/*<>&0123456789.- \n\tgoturnx\x00\xff\xc3'), length).tolist())
        lines = text.split(b"\n")
        one, two = rng.integers(len(lines), size=2).tolist()
        match int(rng.integers(7)):
            case 0:
                text = text[:start] + text[start + length :]
            case 1:
                text = text[:start] + junk + text[start:]
            case 2:
                text = text[:start] + junk + text[start + length :]
            case 3:
                text = text[:start]
            case 4:
                text = text[: start + 3 * length] + text[start:]
            case 5:
                text = b"\n".join([*lines[:one], lines[two], *lines[one:]])
            case 6:
                text = b"\n".join([*lines[:one], *lines[one + 1 :]])
    return text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "text"), [("bif", BIF), ("bif", JAVABAYES), ("xml", XML), ("xml", SAME_XML["indented"])]
)
def test_a_damaged_network_is_refused_in_one_line_or_means_the_same(ending: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / f"net.{ending}"
    path.write_text(text)
    whole = bh.import_network(path)
    outcomes = {"same": 0, "refused": 0}
    for seed in range(1000):
        data = damaged(text.encode(), np.random.default_rng(seed))
        path.write_bytes(data)
        try:
            found = bh.import_network(path)
        except bh.InputError as error:
            said = str(error)
            assert said.startswith(str(path)), (seed, said)
            assert said.isprintable(), (seed, said)
            outcomes["refused"] += 1
            continue
        outcomes["same"] += 1
        # a gait may have got another name, if the file gives it; its tables are the same up to the rounding allowed
        assert all(name in " ".join(data.decode().split()) for name in found.gaits.names), seed
        for variable in ("Gait", "Distance", "Angle", "Heading"):
            assert np.abs(found.probabilities(variable) - whole.probabilities(variable)).max() < 2e-3, (seed, variable)
    assert min(outcomes.values()) > 5
