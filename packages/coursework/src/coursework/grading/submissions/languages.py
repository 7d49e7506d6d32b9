"""The names of gradebook columns in other languages.

Canvas always writes its columns in English (`lib/gradebook_exporter.rb` of instructure/canvas-lms:
the headers are constants, and only the format of numbers follows the language). Moodle's worksheet
uses the words of the language packs (`mod/assign/gradingtable.php` of moodle/moodle: `recordid`,
`maxgrade` and `gradecanbechanged` of `assign`, the others of `moodle`; the packs as of June 2026 in
projectestac/moodle-langpacks, and for Portuguese also the `grade` of earlier versions, as in
mudrd8mz/moodle-lang). We found no public source for Brightspace's other languages, so there an
instructor names the columns.
"""

from collections.abc import Iterable

#: The columns of Moodle's worksheet in English.
MOODLE = (
    "identifier",
    "full name",
    "id number",
    "email address",
    "username",
    "grade",
    "maximum grade",
    "grade can be changed",
)
#: The same columns in other languages, then the word for "no". A bar separates a word from the one
#: that earlier versions used.
LANGUAGES = {
    "German": (
        "ID",
        "Vollständiger Name",
        "ID-Nummer",
        "E-Mail-Adresse",
        "Anmeldename",
        "Bewertung",
        "Bestwertung",
        "Bewertung kann geändert werden",
        "Nein",
    ),
    "French": (
        "Identifiant",
        "Nom complet",
        "Numéro d’identification",
        "Adresse de courriel",
        "Nom d’utilisateur",
        "Note",
        "Note maximale",
        "La note peut être modifiée",
        "Non",
    ),
    "Spanish": (
        "Identificador",
        "Nombre completo",
        "Número de ID",
        "Dirección de correo",
        "Nombre de usuario",
        "Calificación",
        "Calificación máxima",
        "La calificación puede ser cambiada",
        "No",
    ),
    "Italian": (
        "Identificativo",
        "Nome",
        "Codice identificativo",
        "Indirizzo email",
        "Username",
        "Valutazione",
        "Valutazione massima",
        "La valutazione può essere cambiata",
        "No",
    ),
    "Portuguese": (
        "Identificador",
        "Nome completo",
        "Número de identificação (ID)",
        "E-mail",
        "Nome de utilizador",
        "Avaliação|Nota",
        "Nota máxima",
        "A nota pode ser alterada.",
        "Não",
    ),
    "Dutch": (
        "Identificatie",
        "Volledige naam",
        "Nummer (ID)",
        "E-mailadres",
        "Gebruikersnaam",
        "Cijfer",
        "Maximaal cijfer",
        "Het cijfer kan gewijzigd worden",
        "Nee",
    ),
    "Catalan": (
        "Identificador",
        "Nom complet",
        "Número ID",
        "Adreça electrònica",
        "Nom d'usuari",
        "Qualificació",
        "Qualificació màxima",
        "Es pot canviar la qualificació",
        "No",
    ),
    "Swedish": (
        "Identifierare",
        "Fullständigt namn",
        "ID nummer",
        "E-postadress",
        "Användarnamn",
        "Betyg",
        "Maxbetyg",
        "Betyg kan ändras",
        "Nej",
    ),
    "Greek": (
        "Αναγνωριστικό",
        "Πλήρες όνομα",
        "Αναγνωριστικός αριθμός",
        "Διεύθυνση ηλε.ταχυδρομείου",
        "Όνομα χρήστη",
        "Βαθμός",
        "Μέγιστος Βαθμός",
        "Ο βαθμός μπορεί να αλλάξει",
        "Όχι",
    ),
    "Basque": (
        "Identifikatzailea",
        "Izen osoa",
        "ID zenbakia",
        "Helbide elektronikoa",
        "Erabiltzaile-izena",
        "Kalifikazioa",
        "Gehieneko kalifikazioa",
        "Kalifikazioa alda daiteke",
        "Ez",
    ),
    "Galician": (
        "Identificador",
        "Nome completo",
        "Número ID",
        "Enderezo de correo",
        "Nome de usuario",
        "Cualificación",
        "Cualificación máxima",
        "A cualificación pode seren cambiada",
        "Non",
    ),
    "Japanese": (
        "ID",
        "フルネーム",
        "IDナンバ",
        "メールアドレス",
        "ユーザ名",
        "評点",
        "最大評点",
        "評点変更可",
        "No",
    ),
    "Korean": (
        "식별자",
        "전체 이름",
        "id 번호",
        "이메일 주소",
        "사용자 아이디",
        "성적",
        "최대 성적",
        "",
        "아니오",
    ),
    "Lithuanian": (
        "Identifikatorius",
        "Visas pavadinimas",
        "ID numeris",
        "El. pašto adresas",
        "Naudotojo vardas",
        "Įvertinimas",
        "Didžiausias įvertinimas",
        "Įvertinimas gali būti pakeistas",
        "Ne",
    ),
    "Romanian": (
        "Identificator",
        "Nume complet",
        "Număr ID",
        "Adresa de e-mail",
        "Nume de utilizator",
        "Notă",
        "Notă maximă",
        "Nota poate fi schimbată",
        "Nu",
    ),
    "Russian": (
        "Идентификатор",
        "Полное имя",
        "Индивидуальный номер",
        "Адрес электронной почты",
        "Логин",
        "Оценка",
        "Максимальная оценка",
        "Оценка может быть изменена",
        "Нет",
    ),
    "Turkish": (
        "Tanımlayıcı",
        "Tam adı",
        "ID numarası",
        "E-posta adresi",
        "Kullanıcı adı",
        "Not",
        "Enyüksek not",
        "Not değiştirilebilir",
        "Hayır",
    ),
    "Ukrainian": (
        "Ідентифікатор",
        "Повна назва",
        "Індивідуальний номер",
        "Електронна пошта",
        "Ім’я входу",
        "Оцінка",
        "Максимальна оцінка",
        "Оцінка може бути змінена",
        "Ні",
    ),
    "Chinese": (
        "标识符",
        "全名",
        "学号",
        "电子邮件地址",
        "用户名",
        "成绩",
        "最高分",
        "允许更改成绩",
        "否",
    ),
    "Arabic": (
        "المُعرَّف",
        "ًالاسم كاملا",
        "رقم المُعرَّف",
        "عنوان البريد الإلكتروني",
        "اسم المستخدم",
        "الدرجة",
        "أعلى تقدير",
        "يمكن تغيير الدرجة",
        "لا",
    ),
}


#: The words of all languages for each of these columns, with plain apostrophes.
IN_ALL = {
    ours: tuple(words[place].casefold().replace("’", "'") for words in LANGUAGES.values())
    for place, ours in enumerate(MOODLE)
}


def in_english(header: Iterable[str]) -> tuple[dict[str, str], str]:
    """Translate the columns of a Moodle worksheet into English, and return its word for "no".

    The language is recognised by the two columns that every worksheet has: the identifier and the
    grade. A spreadsheet may have made an apostrophe plain.

    >>> in_english(["ID", "Vollst\xe4ndiger Name", "Bewertung"])
    ({'id': 'identifier', 'vollst\xe4ndiger name': 'full name', 'bewertung': 'grade'}, 'nein')
    >>> in_english(["Student", "ID", "Section"])
    ({}, 'no')
    """
    there = {
        name.replace("’", "'"): name for name in (heading.strip().casefold() for heading in header)
    }
    for *words, no in LANGUAGES.values():
        known = {
            there[theirs]: ours
            for ours, word in zip(MOODLE, words, strict=True)
            for theirs in word.casefold().replace("’", "'").split("|")
            if theirs and theirs in there
        }
        if {"identifier", "grade"} <= set(known.values()):
            return known, no.casefold()
    return {}, "no"
