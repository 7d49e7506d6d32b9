"""Readers of Moodle XML and QTI for the tests, based on the formats and not on our writer."""

import html
import re
import xml.etree.ElementTree as ET
import zipfile

QTI = "{http://www.imsglobal.org/xsd/imsqti_v2p2}"
#: An entry of a cloze question, and in it an answer: its share of the points, text and reply.
PLACE = re.compile(r"\{1:([A-Z]+):((?:[^}\\]|\\.)*)\}")
ANSWER = re.compile(r"(=|%([\d.]+)%)?((?:&#?\w+;|[^~#])*)(?:#([^~]*))?", re.S)


def of_moodle(file):
    """Return the questions of a file by name, each a list of entries, each a list of answers."""
    questions = {}
    for question in ET.parse(file).getroot():
        if question.get("type") == "category":
            continue
        places = []
        if question.get("type") == "cloze":
            for kind, answers in PLACE.findall(question.findtext("questiontext/text")):
                places.append(
                    [
                        _of_cloze(kind, *ANSWER.match(answer).groups())
                        for answer in answers.split("~")
                    ]
                )
        else:
            places.append(
                [
                    (
                        float(answer.get("fraction")) / 100,
                        answer.findtext("text"),
                        answer.findtext("tolerance"),
                        answer.findtext("feedback/text"),
                    )
                    for answer in question.findall("answer")
                ]
            )
        questions[question.findtext("name/text")] = places
    return questions


def _of_cloze(kind, earns, percent, answer, reply):
    answer, _, tolerance = answer.partition(":") if kind == "NUMERICAL" else (answer, "", None)
    share = 1 if earns == "=" else float(percent or 0) / 100
    return share, html.unescape(answer), tolerance, html.unescape(reply or "")


def marked_by_moodle(places, values):
    """Return the share of the points that an answer earns, and all replies to it."""
    earned, replies = 0, ""
    for answers, value in zip(places, values, strict=True):
        for share, answer, tolerance, reply in answers:
            if _same(answer, value, tolerance):
                earned, replies = earned + share / len(places), replies + reply
                break
    return earned, replies


def _same(answer, value, tolerance):
    if tolerance is None:
        return html.unescape(answer).lower() == value.lower()
    return abs(float(answer) - float(value)) <= float(tolerance)


def of_qti(file):
    """Return the items of a package by title; its manifest must name all of its files."""
    with zipfile.ZipFile(file) as package:
        documents = {name: package.read(name) for name in package.namelist()}
    manifest = ET.fromstring(documents["imsmanifest.xml"])
    assert {entry.get("href") for entry in manifest.findall(".//{*}file")} == documents.keys() - {
        "imsmanifest.xml"
    }
    references = ET.fromstring(documents["test.xml"]).iter(f"{QTI}assessmentItemRef")
    items = [ET.fromstring(documents[reference.get("href")]) for reference in references]
    return {item.get("title"): item for item in items}


def marked_by_qti(item, values):
    """Return the share of the points that an answer earns, and the reply to it."""
    words = {
        (interaction.get("responseIdentifier"), choice.text): choice.get("identifier")
        for interaction in item.iter(f"{QTI}inlineChoiceInteraction")
        for choice in interaction
    }
    given = {
        f"R{place}": words.get((f"R{place}", value), value) for place, value in enumerate(values)
    }
    outcomes = {
        declaration.get("identifier"): declaration.findtext(f"{QTI}defaultValue/{QTI}value")
        for declaration in item.iter(f"{QTI}outcomeDeclaration")
    }
    for branch in item.find(f"{QTI}responseProcessing/{QTI}responseCondition"):
        every, *sets = branch
        if all(_holds(test, given) for test in every):
            outcomes |= {
                setting.get("identifier"): setting.findtext(f"{QTI}baseValue") for setting in sets
            }
            break
    replies = {
        feedback.get("identifier"): ET.tostring(feedback, "unicode", "xml")
        for feedback in item.iter(f"{QTI}modalFeedback")
    }
    return float(outcomes["SCORE"]) / float(outcomes["MAXSCORE"]), replies.get(
        outcomes["FEEDBACK"], ""
    )


def _holds(test, given):
    value, expected = given[test[0].get("identifier")], test[1].text
    tolerance = test.get("tolerance", "").split()
    return _same(expected, value, tolerance[0] if tolerance else None)
