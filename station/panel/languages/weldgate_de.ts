<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>alarms</name>
    <message>
        <source>code</source>
        <translation>Code</translation>
    </message>
    <message>
        <source>cause</source>
        <translation>Ursache</translation>
    </message>
    <message>
        <source>what to do</source>
        <translation>was zu tun ist</translation>
    </message>
    <message>
        <source>since</source>
        <translation>seit</translation>
    </message>
    <message>
        <source>until</source>
        <translation>bis</translation>
    </message>
    <message>
        <source>acknowledged by</source>
        <translation>quittiert von</translation>
    </message>
    <message>
        <source>Acknowledge</source>
        <translation>Quittieren</translation>
    </message>
    <message>
        <source>Choose an alarm to acknowledge it; who is logged in is noted.</source>
        <translation>Zum Quittieren einen Alarm wählen; vermerkt wird, wer angemeldet ist.</translation>
    </message>
    <message>
        <source>lasts</source>
        <translation>dauert an</translation>
    </message>
    <message>
        <source>log in first (page Setup)</source>
        <translation>erst anmelden (Seite Einrichten)</translation>
    </message>
    <message>
        <source>choose an alarm first</source>
        <translation>erst einen Alarm wählen</translation>
    </message>
</context>
<context>
    <name>camera</name>
    <message>
        <source>Live pictures</source>
        <translation>Laufende Bilder</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>reason (needed)</source>
        <translation>Grund (nötig)</translation>
    </message>
    <message>
        <source>grey levels</source>
        <translation>Graustufen</translation>
    </message>
    <message>
        <source>sharpness · best so far</source>
        <translation>Schärfe · beste bisher</translation>
    </message>
    <message>
        <source>brightness (0 to 255)</source>
        <translation>Helligkeit (0 bis 255)</translation>
    </message>
    <message>
        <source>saturated</source>
        <translation>übersteuert</translation>
    </message>
    <message>
        <source>ring radius · expected px</source>
        <translation>Ringradius · erwartet px</translation>
    </message>
    <message>
        <source>ring residual px · support</source>
        <translation>Ring-Abweichung px · Anteil</translation>
    </message>
    <message>
        <source>exposure</source>
        <translation>Belichtung</translation>
    </message>
    <message>
        <source>gain</source>
        <translation>Verstärkung</translation>
    </message>
    <message>
        <source>settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>saved and in use</source>
        <translation>gespeichert und in Gebrauch</translation>
    </message>
    <message>
        <source>nothing was changed:</source>
        <translation>nichts wurde geändert:</translation>
    </message>
    <message>
        <source>waiting for the engine</source>
        <translation>wartet auf die Prüfung</translation>
    </message>
    <message>
        <source>log in as setter first</source>
        <translation>erst als Einrichter anmelden</translation>
    </message>
</context>
<context>
    <name>data</name>
    <message>
        <source>OK</source>
        <translation>OK</translation>
    </message>
    <message>
        <source>NOK</source>
        <translation>NOK</translation>
    </message>
    <message>
        <source>ERROR</source>
        <translation>FEHLER</translation>
    </message>
    <message>
        <source>TEST</source>
        <translation>TEST</translation>
    </message>
    <message>
        <source>OFFLINE</source>
        <translation>OFFLINE</translation>
    </message>
    <message>
        <source>PLC LOST</source>
        <translation>SPS FEHLT</translation>
    </message>
    <message>
        <source>NO VERDICT</source>
        <translation>KEIN URTEIL</translation>
    </message>
    <message>
        <source>SERVICE</source>
        <translation>SERVICE</translation>
    </message>
    <message>
        <source>waiting for a part</source>
        <translation>wartet auf ein Teil</translation>
    </message>
    <message>
        <source>21 of 21 segments</source>
        <translation>21 von 21 Segmenten</translation>
    </message>
    <message>
        <source>test picture</source>
        <translation>Testbild</translation>
    </message>
    <message>
        <source>master</source>
        <translation>Meisterteil</translation>
    </message>
    <message>
        <source>replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <source>result came too late for the PLC</source>
        <translation>Ergebnis kam zu spät für die SPS</translation>
    </message>
    <message>
        <source>hole</source>
        <translation>Loch</translation>
    </message>
    <message>
        <source>missing weld</source>
        <translation>fehlende Naht</translation>
    </message>
    <message>
        <source>no weld found</source>
        <translation>keine Naht gefunden</translation>
    </message>
    <message>
        <source>weld not wholly in view</source>
        <translation>Naht nicht ganz im Bild</translation>
    </message>
    <message>
        <source>frame has the wrong size</source>
        <translation>Bild hat falsche Größe</translation>
    </message>
    <message>
        <source>frame incompletely grabbed</source>
        <translation>Bild unvollständig übertragen</translation>
    </message>
    <message>
        <source>image too dark</source>
        <translation>Bild zu dunkel</translation>
    </message>
    <message>
        <source>image too bright</source>
        <translation>Bild zu hell</translation>
    </message>
    <message>
        <source>image blurred</source>
        <translation>Bild unscharf</translation>
    </message>
    <message>
        <source>camera lost</source>
        <translation>Kamera verloren</translation>
    </message>
    <message>
        <source>no frame in time</source>
        <translation>kein Bild rechtzeitig</translation>
    </message>
    <message>
        <source>deadline missed</source>
        <translation>Frist verpasst</translation>
    </message>
    <message>
        <source>classifier failed</source>
        <translation>Klassifikator versagte</translation>
    </message>
    <message>
        <source>record could not be written</source>
        <translation>Datensatz nicht schreibbar</translation>
    </message>
    <message>
        <source>aborted by the PLC</source>
        <translation>von der SPS abgebrochen</translation>
    </message>
    <message>
        <source>internal error</source>
        <translation>interner Fehler</translation>
    </message>
    <message>
        <source>camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>simulated</source>
        <translation>simuliert</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>golden</source>
        <translation>Meisterteil</translation>
    </message>
    <message>
        <source>test</source>
        <translation>Test</translation>
    </message>
    <message>
        <source>the PLC has not enabled the station</source>
        <translation>die SPS hat die Station nicht freigegeben</translation>
    </message>
    <message>
        <source>the PLC has set the station offline</source>
        <translation>die SPS hat die Station offline gesetzt</translation>
    </message>
    <message>
        <source>no records can be written</source>
        <translation>keine Datensätze schreibbar</translation>
    </message>
    <message>
        <source>the stored frame is judged differently</source>
        <translation>das gespeicherte Bild wird anders beurteilt</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check that a part lies in the nest, and the camera&apos;s view</source>
        <translation>Teil neu prüfen; tritt es erneut auf: prüfen, ob ein Teil im Nest liegt, und die Sicht der Kamera</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the part&apos;s seat and the camera&apos;s position</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Sitz des Teils und Lage der Kamera prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, set width and height of the camera as in the settings</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Breite und Höhe der Kamera wie in den Einstellungen setzen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check network cable, switch and jumbo frames</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Netzkabel, Switch und Jumbo-Frames prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the light and the exposure</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Licht und Belichtung prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check focus and glass, and that the part stands still</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Fokus und Glas prüfen, und ob das Teil still steht</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check power and cable of the camera</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Strom und Kabel der Kamera prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the trigger line and camera.timeout_ms</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Triggerleitung und camera.timeout_ms prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, restart the station, restore the model file</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Station neu starten, Modelldatei wiederherstellen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, check the archive&apos;s disk</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Platte des Archivs prüfen</translation>
    </message>
    <message>
        <source>judge the part again; if it comes back, send the engine&apos;s log to the maker</source>
        <translation>Teil neu prüfen; tritt es erneut auf: Logdatei der Station an den Hersteller senden</translation>
    </message>
    <message>
        <source>no result within the deadline</source>
        <translation>kein Ergebnis innerhalb der Frist</translation>
    </message>
    <message>
        <source>see cycle times on the page Statistics; check the PC&apos;s load</source>
        <translation>Taktzeiten auf der Seite Statistik ansehen; Last des PCs prüfen</translation>
    </message>
    <message>
        <source>the PLC aborted the part</source>
        <translation>die SPS hat das Teil abgebrochen</translation>
    </message>
    <message>
        <source>see the line&apos;s program</source>
        <translation>siehe Programm der Linie</translation>
    </message>
    <message>
        <source>TRIGGER_ID was 0 or repeated</source>
        <translation>TRIGGER_ID war 0 oder wiederholt</translation>
    </message>
    <message>
        <source>correct the PLC program: each part needs a new number</source>
        <translation>SPS-Programm berichtigen: jedes Teil braucht eine neue Nummer</translation>
    </message>
    <message>
        <source>TRIGGER or RESULT_ACK was held too long</source>
        <translation>TRIGGER oder RESULT_ACK zu lange gehalten</translation>
    </message>
    <message>
        <source>correct the PLC program: see the page Line</source>
        <translation>SPS-Programm berichtigen: siehe Seite Linie</translation>
    </message>
    <message>
        <source>the link was lost while the result was written</source>
        <translation>Verbindung riss beim Schreiben des Ergebnisses</translation>
    </message>
    <message>
        <source>check the network to the PLC</source>
        <translation>Netz zur SPS prüfen</translation>
    </message>
    <message>
        <source>check power and cable of the camera; the station connects again by itself</source>
        <translation>Strom und Kabel der Kamera prüfen; die Station verbindet sich selbst wieder</translation>
    </message>
    <message>
        <source>make room on the archive&apos;s disk, check that it is writable</source>
        <translation>Platz auf der Platte des Archivs schaffen, Schreibrecht prüfen</translation>
    </message>
    <message>
        <source>the archive&apos;s disk fills</source>
        <translation>die Platte des Archivs füllt sich</translation>
    </message>
    <message>
        <source>make room, or keep less (archive.keep)</source>
        <translation>Platz schaffen oder weniger aufheben (archive.keep)</translation>
    </message>
    <message>
        <source>the PLC&apos;s heartbeat stands still</source>
        <translation>der Herzschlag der SPS steht</translation>
    </message>
    <message>
        <source>check the PLC program and the network to the PLC</source>
        <translation>SPS-Programm und Netz zur SPS prüfen</translation>
    </message>
    <message>
        <source>restart the station; check the PC&apos;s memory</source>
        <translation>Station neu starten; Speicher des PCs prüfen</translation>
    </message>
    <message>
        <source>a master was judged wrongly</source>
        <translation>ein Meisterteil wurde falsch beurteilt</translation>
    </message>
    <message>
        <source>check master, light and focus; judge the master again</source>
        <translation>Meisterteil, Licht und Fokus prüfen; Meisterteil neu prüfen</translation>
    </message>
    <message>
        <source>the check of the masters is due</source>
        <translation>die Prüfung der Meisterteile ist fällig</translation>
    </message>
    <message>
        <source>put the masters in and judge them</source>
        <translation>Meisterteile einlegen und prüfen</translation>
    </message>
    <message>
        <source>the pictures drift</source>
        <translation>die Bilder driften</translation>
    </message>
    <message>
        <source>check light, focus, glass and the surface of the parts</source>
        <translation>Licht, Fokus, Glas und Oberfläche der Teile prüfen</translation>
    </message>
    <message>
        <source>changed settings could not be used</source>
        <translation>geänderte Einstellungen unbrauchbar</translation>
    </message>
    <message>
        <source>see the engine&apos;s log; the settings before are in use</source>
        <translation>siehe Logdatei der Station; die bisherigen Einstellungen gelten</translation>
    </message>
    <message>
        <source>login</source>
        <translation>Anmeldung</translation>
    </message>
    <message>
        <source>login failed</source>
        <translation>Anmeldung gescheitert</translation>
    </message>
    <message>
        <source>logout</source>
        <translation>Abmeldung</translation>
    </message>
    <message>
        <source>user</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>setting</source>
        <translation>Einstellung</translation>
    </message>
    <message>
        <source>review</source>
        <translation>Nachprüfung</translation>
    </message>
    <message>
        <source>service</source>
        <translation>Service</translation>
    </message>
    <message>
        <source>alarm</source>
        <translation>Alarm</translation>
    </message>
    <message>
        <source>alarm over</source>
        <translation>Alarm vorbei</translation>
    </message>
    <message>
        <source>alarm acknowledged</source>
        <translation>Alarm quittiert</translation>
    </message>
    <message>
        <source>right</source>
        <translation>richtig</translation>
    </message>
    <message>
        <source>false call</source>
        <translation>Fehlalarm</translation>
    </message>
    <message>
        <source>missed defect</source>
        <translation>übersehener Fehler</translation>
    </message>
    <message>
        <source>not reviewed</source>
        <translation>nicht nachgeprüft</translation>
    </message>
    <message>
        <source>reviewed once</source>
        <translation>einmal nachgeprüft</translation>
    </message>
    <message>
        <source>two agree</source>
        <translation>zwei sind einig</translation>
    </message>
    <message>
        <source>disputed</source>
        <translation>strittig</translation>
    </message>
    <message>
        <source>operator</source>
        <translation>Bediener</translation>
    </message>
    <message>
        <source>setter</source>
        <translation>Einrichter</translation>
    </message>
    <message>
        <source>quality</source>
        <translation>Qualität</translation>
    </message>
    <message>
        <source>admin</source>
        <translation>Administrator</translation>
    </message>
    <message>
        <source>station</source>
        <translation>Station</translation>
    </message>
    <message>
        <source>PLC</source>
        <translation>SPS</translation>
    </message>
    <message>
        <source>idle</source>
        <translation>untätig</translation>
    </message>
    <message>
        <source>asked to</source>
        <translation>auf Wunsch</translation>
    </message>
    <message>
        <source>window closed</source>
        <translation>Fenster geschlossen</translation>
    </message>
    <message>
        <source>cleared by RESULT_ACK</source>
        <translation>gelöscht durch RESULT_ACK</translation>
    </message>
    <message>
        <source>cleared by the next TRIGGER, not acknowledged</source>
        <translation>gelöscht durch den nächsten TRIGGER, nicht quittiert</translation>
    </message>
    <message>
        <source>cleared by the station: too old, offline or link lost, not acknowledged</source>
        <translation>von der Station gelöscht: zu alt, offline oder Verbindung fort, nicht quittiert</translation>
    </message>
    <message>
        <source>PLC_HEARTBEAT stands still</source>
        <translation>PLC_HEARTBEAT steht</translation>
    </message>
    <message>
        <source>TRIGGER not taken</source>
        <translation>TRIGGER nicht angenommen</translation>
    </message>
    <message>
        <source>the station&apos;s disk fills</source>
        <translation>die Platte der Station füllt sich</translation>
    </message>
    <message>
        <source>the disk was too slow</source>
        <translation>die Platte war zu langsam</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER while READY was 0</source>
        <translation>Regelbruch: TRIGGER bei READY 0</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER dropped before TRIGGER_ACK</source>
        <translation>Regelbruch: TRIGGER vor TRIGGER_ACK zurückgenommen</translation>
    </message>
    <message>
        <source>rule broken: RESULT_ACK without RESULT_VALID</source>
        <translation>Regelbruch: RESULT_ACK ohne RESULT_VALID</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER_ID 0 or repeated</source>
        <translation>Regelbruch: TRIGGER_ID 0 oder wiederholt</translation>
    </message>
    <message>
        <source>rule broken: TRIGGER or RESULT_ACK held too long</source>
        <translation>Regelbruch: TRIGGER oder RESULT_ACK zu lange gehalten</translation>
    </message>
    <message>
        <source>a name of 1 to 40 characters is needed</source>
        <translation>ein Name von 1 bis 40 Zeichen ist nötig</translation>
    </message>
    <message>
        <source>a PIN of 4 to 12 digits is needed</source>
        <translation>eine PIN von 4 bis 12 Ziffern ist nötig</translation>
    </message>
    <message>
        <source>at least one administrator is needed</source>
        <translation>mindestens ein Administrator ist nötig</translation>
    </message>
    <message>
        <source>unknown name or wrong PIN</source>
        <translation>Name unbekannt oder PIN falsch</translation>
    </message>
    <message>
        <source>no picture came</source>
        <translation>es kam kein Bild</translation>
    </message>
    <message>
        <source>its picture is no longer kept</source>
        <translation>das Bild wird nicht mehr aufgehoben</translation>
    </message>
    <message>
        <source>another model judged it: where that saw defects is not known</source>
        <translation>ein anderes Modell hat es beurteilt: wo das Fehler sah, ist nicht bekannt</translation>
    </message>
    <message>
        <source>a login of the level operator is needed</source>
        <translation>eine Anmeldung als Bediener ist nötig</translation>
    </message>
    <message>
        <source>a login of the level setter is needed</source>
        <translation>eine Anmeldung als Einrichter ist nötig</translation>
    </message>
    <message>
        <source>a login of the level quality is needed</source>
        <translation>eine Anmeldung als Qualität ist nötig</translation>
    </message>
    <message>
        <source>a login of the level admin is needed</source>
        <translation>eine Anmeldung als Administrator ist nötig</translation>
    </message>
    <message>
        <source>the second review needs the level quality</source>
        <translation>die zweite Nachprüfung braucht die Stufe Qualität</translation>
    </message>
    <message>
        <source>no connection to the engine</source>
        <translation>keine Verbindung zum Prüfprogramm</translation>
    </message>
    <message>
        <source>is working on the station</source>
        <translation>arbeitet an der Station</translation>
    </message>
    <message>
        <source>test image</source>
        <translation>Testbild</translation>
    </message>
    <message>
        <source>verdict cannot be trusted: see page Alarms</source>
        <translation>Urteil nicht verlässlich: siehe Seite Alarme</translation>
    </message>
    <message>
        <source>master check is due: the PLC releases no parts</source>
        <translation>Meisterteilprüfung fällig: die SPS gibt keine Teile frei</translation>
    </message>
    <message>
        <source>the station is starting</source>
        <translation>die Station startet</translation>
    </message>
    <message>
        <source>records cannot be written</source>
        <translation>Datensätze nicht schreibbar</translation>
    </message>
    <message>
        <source>the inspection has stopped</source>
        <translation>die Prüfung steht</translation>
    </message>
    <message>
        <source>a recipe is being loaded</source>
        <translation>ein Rezept wird geladen</translation>
    </message>
    <message>
        <source>self-test failed</source>
        <translation>Selbsttest nicht bestanden</translation>
    </message>
    <message>
        <source>an image is being taken or settings are being loaded on request of a window</source>
        <translation>auf Anforderung eines Fensters wird ein Bild aufgenommen oder werden Einstellungen geladen</translation>
    </message>
    <message>
        <source>No connection to the engine.</source>
        <translation>Keine Verbindung zum Prüfprogramm.</translation>
    </message>
    <message>
        <source>no weld was found in it</source>
        <translation>es wurde keine Naht darin gefunden</translation>
    </message>
    <message>
        <source>the request came too late: nothing was done</source>
        <translation>die Anfrage kam zu spät: nichts wurde getan</translation>
    </message>
    <message>
        <source>internal error: see the engine&apos;s log</source>
        <translation>interner Fehler: siehe Logdatei der Station</translation>
    </message>
    <message>
        <source>somebody else works on the station</source>
        <translation>jemand anderes arbeitet an der Station</translation>
    </message>
    <message>
        <source>there is no such alarm</source>
        <translation>diesen Alarm gibt es nicht</translation>
    </message>
    <message>
        <source>a reason is needed</source>
        <translation>ein Grund ist nötig</translation>
    </message>
    <message>
        <source>there was no moment without a part in work: nothing was changed</source>
        <translation>es gab keinen Augenblick ohne Teil in Arbeit: nichts wurde geändert</translation>
    </message>
    <message>
        <source>too many changes of settings wait: try again</source>
        <translation>zu viele Änderungen von Einstellungen warten: erneut versuchen</translation>
    </message>
    <message>
        <source>the camera cannot be used with these values: see the engine&apos;s log</source>
        <translation>die Kamera arbeitet mit diesen Werten nicht: siehe Logdatei der Station</translation>
    </message>
    <message>
        <source>the settings file cannot be used: see the engine&apos;s log; the settings before stay in use</source>
        <translation>die Einstellungsdatei ist nicht verwendbar: siehe Logdatei der Station; die bisherigen Einstellungen gelten</translation>
    </message>
    <message>
        <source>not in the settings file at the start</source>
        <translation>beim Start nicht in der Einstellungsdatei</translation>
    </message>
    <message>
        <source>the settings file said otherwise at the start</source>
        <translation>beim Start stand in der Einstellungsdatei etwas anderes</translation>
    </message>
    <message>
        <source>settings file</source>
        <translation>Einstellungsdatei</translation>
    </message>
    <message>
        <source>read again</source>
        <translation>neu gelesen</translation>
    </message>
    <message>
        <source>the engine stops</source>
        <translation>die Prüfung endet</translation>
    </message>
    <message>
        <source>service mode</source>
        <translation>Service-Betrieb</translation>
    </message>
    <message>
        <source>bit by hand</source>
        <translation>Bit von Hand</translation>
    </message>
    <message>
        <source>counters</source>
        <translation>Zähler</translation>
    </message>
    <message>
        <source>begins</source>
        <translation>beginnt</translation>
    </message>
    <message>
        <source>over</source>
        <translation>beendet</translation>
    </message>
    <message>
        <source>another one logs in</source>
        <translation>ein anderer meldet sich an</translation>
    </message>
    <message>
        <source>user changed</source>
        <translation>Benutzer geändert</translation>
    </message>
</context>
<context>
    <name>field</name>
    <message>
        <source>allowed: </source>
        <translation>erlaubt: </translation>
    </message>
</context>
<context>
    <name>history</name>
    <message>
        <source>serial, or its beginning with *</source>
        <translation>Seriennummer, oder ihr Anfang mit *</translation>
    </message>
    <message>
        <source>from … to …</source>
        <translation>von … bis …</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>any time</source>
        <translation>jede Zeit</translation>
    </message>
    <message>
        <source>from</source>
        <translation>von</translation>
    </message>
    <message>
        <source>to</source>
        <translation>bis</translation>
    </message>
    <message>
        <source>last hour</source>
        <translation>letzte Stunde</translation>
    </message>
    <message>
        <source>last 8 hours</source>
        <translation>letzte 8 Stunden</translation>
    </message>
    <message>
        <source>last day</source>
        <translation>letzter Tag</translation>
    </message>
    <message>
        <source>last week</source>
        <translation>letzte Woche</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>review</source>
        <translation>Nachprüfung</translation>
    </message>
    <message>
        <source>to be confirmed</source>
        <translation>zu bestätigen</translation>
    </message>
    <message>
        <source>Search</source>
        <translation>Suchen</translation>
    </message>
    <message>
        <source>Gallery</source>
        <translation>Galerie</translation>
    </message>
    <message>
        <source>comment</source>
        <translation>Bemerkung</translation>
    </message>
    <message>
        <source>Verdict is right</source>
        <translation>Urteil stimmt</translation>
    </message>
    <message>
        <source>False call</source>
        <translation>Fehlalarm</translation>
    </message>
    <message>
        <source>Missed defect</source>
        <translation>Übersehen</translation>
    </message>
    <message>
        <source>Defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>Table…</source>
        <translation>Tabelle…</translation>
    </message>
    <message>
        <source>the parts that were found, as CSV</source>
        <translation>die gefundenen Teile als CSV</translation>
    </message>
    <message>
        <source>Export reviewed…</source>
        <translation>Nachgeprüfte ausgeben…</translation>
    </message>
    <message>
        <source>the newest 300</source>
        <translation>die neuesten 300</translation>
    </message>
    <message>
        <source>parts</source>
        <translation>Teile</translation>
    </message>
    <message>
        <source>log in to review</source>
        <translation>zum Nachprüfen anmelden</translation>
    </message>
    <message>
        <source>touch the cells in which a defect was missed</source>
        <translation>die Zellen antippen, in denen ein Fehler übersehen wurde</translation>
    </message>
    <message>
        <source>pictures</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>Folder for the crops of reviewed parts</source>
        <translation>Ordner für die Ausschnitte nachgeprüfter Teile</translation>
    </message>
    <message>
        <source>table</source>
        <translation>Tabelle</translation>
    </message>
    <message>
        <source>defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>left out</source>
        <translation>ausgelassen</translation>
    </message>
    <message>
        <source>export</source>
        <translation>Ausgabe</translation>
    </message>
    <message>
        <source>finding</source>
        <translation>Befund</translation>
    </message>
    <message>
        <source>from °</source>
        <translation>von °</translation>
    </message>
    <message>
        <source>to °</source>
        <translation>bis °</translation>
    </message>
    <message>
        <source>length mm</source>
        <translation>Länge mm</translation>
    </message>
    <message>
        <source>width mm</source>
        <translation>Breite mm</translation>
    </message>
    <message>
        <source>area mm²</source>
        <translation>Fläche mm²</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>verdict</source>
        <translation>Urteil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>seen by the PLC</source>
        <translation>von der SPS gesehen</translation>
    </message>
    <message>
        <source>part · trigger</source>
        <translation>Teil · Trigger</translation>
    </message>
    <message>
        <source>brightness · sharpness · saturated</source>
        <translation>Helligkeit · Schärfe · übersteuert</translation>
    </message>
    <message>
        <source>ring x · y · r · residual px</source>
        <translation>Ring x · y · r · Abweichung px</translation>
    </message>
    <message>
        <source>distance to the training images</source>
        <translation>Abstand zu den Trainingsbildern</translation>
    </message>
    <message>
        <source>steps ms</source>
        <translation>Zeiten ms</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzen</translation>
    </message>
    <message>
        <source>model · recipe</source>
        <translation>Modell · Rezept</translation>
    </message>
    <message>
        <source>model&apos;s hash · configuration</source>
        <translation>Modell-Hash · Konfiguration</translation>
    </message>
    <message>
        <source>origin · purpose</source>
        <translation>Herkunft · Zweck</translation>
    </message>
    <message>
        <source>findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>the record cannot be read</source>
        <translation>der Datensatz ist nicht lesbar</translation>
    </message>
    <message>
        <source>no part</source>
        <translation>kein Teil</translation>
    </message>
    <message>
        <source>its picture cannot be read</source>
        <translation>das Bild ist nicht lesbar</translation>
    </message>
    <message>
        <source>tolerated</source>
        <translation>geduldet</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>ja</translation>
    </message>
    <message>
        <source>no</source>
        <translation>nein</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>unbekannt</translation>
    </message>
</context>
<context>
    <name>journal</name>
    <message>
        <source>everything</source>
        <translation>alles</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>who</source>
        <translation>wer</translation>
    </message>
    <message>
        <source>what</source>
        <translation>was</translation>
    </message>
    <message>
        <source>of</source>
        <translation>woran</translation>
    </message>
    <message>
        <source>before</source>
        <translation>vorher</translation>
    </message>
    <message>
        <source>after</source>
        <translation>nachher</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>saved</source>
        <translation>gespeichert</translation>
    </message>
    <message>
        <source>removed</source>
        <translation>entfernt</translation>
    </message>
</context>
<context>
    <name>line</name>
    <message>
        <source>register</source>
        <translation>Register</translation>
    </message>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>by</source>
        <translation>von</translation>
    </message>
    <message>
        <source>what</source>
        <translation>was</translation>
    </message>
    <message>
        <source>note</source>
        <translation>Anmerkung</translation>
    </message>
    <message>
        <source>no word from the engine: the registers are as they last were</source>
        <translation>die Prüfung meldet sich nicht: Register, wie sie zuletzt waren</translation>
    </message>
    <message>
        <source>Service mode</source>
        <translation>Service-Betrieb</translation>
    </message>
    <message>
        <source>no bit</source>
        <translation>kein Bit</translation>
    </message>
    <message>
        <source>station</source>
        <translation>Station</translation>
    </message>
    <message>
        <source>set one bit of STATUS by hand:</source>
        <translation>ein Bit von STATUS von Hand setzen:</translation>
    </message>
    <message>
        <source>Registers as the PLC has them</source>
        <translation>Register, wie die SPS sie hat</translation>
    </message>
    <message>
        <source>Edges on the bus, the newest first</source>
        <translation>Flanken auf dem Bus, die neueste zuerst</translation>
    </message>
    <message>
        <source>Word order: TEST_U32 must read 16#12345678 (305419896), TEST_F32 123.456. Sent words:</source>
        <translation>Wortfolge: TEST_U32 muss 16#12345678 (305419896) ergeben, TEST_F32 123,456. Gesendete Worte:</translation>
    </message>
    <message>
        <source>If the PLC reads 16#56781234, exchange its words or set plc.low_word_first.</source>
        <translation>Liest die SPS 16#56781234, dort die Worte tauschen oder plc.low_word_first setzen.</translation>
    </message>
    <message>
        <source>log in as setter first (page Setup)</source>
        <translation>erst als Einrichter anmelden (Seite Einrichten)</translation>
    </message>
</context>
<context>
    <name>live</name>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>cycle</source>
        <translation>Takt</translation>
    </message>
    <message>
        <source>picture</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>parts</source>
        <translation>Teile</translation>
    </message>
    <message>
        <source>not judged</source>
        <translation>ungeprüft</translation>
    </message>
    <message>
        <source>yield</source>
        <translation>Ausbeute</translation>
    </message>
    <message>
        <source>Test picture</source>
        <translation>Testbild</translation>
    </message>
    <message>
        <source>Take a picture of what lies there now and judge it; the PLC is told nothing</source>
        <translation>Bild von dem, was gerade da liegt, aufnehmen und beurteilen; die SPS erfährt nichts</translation>
    </message>
    <message>
        <source>Hold</source>
        <translation>Halten</translation>
    </message>
    <message>
        <source>The picture stays; lamp and counters go on</source>
        <translation>Das Bild bleibt stehen; Lampe und Zähler laufen weiter</translation>
    </message>
    <message>
        <source>Defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>Where the network sees defects in the last NOK part</source>
        <translation>Wo das Netz im letzten NOK-Teil Fehler sieht</translation>
    </message>
    <message>
        <source>NOK segments of the last parts</source>
        <translation>NOK-Segmente der letzten Teile</translation>
    </message>
    <message>
        <source>last NOK</source>
        <translation>letztes NOK</translation>
    </message>
    <message>
        <source>known</source>
        <translation>bekannt</translation>
    </message>
    <message>
        <source>UNLIKE TRAINING</source>
        <translation>FREMDARTIG</translation>
    </message>
    <message>
        <source>DRIFTING</source>
        <translation>DRIFTET</translation>
    </message>
    <message>
        <source>HELD</source>
        <translation>GEHALTEN</translation>
    </message>
    <message>
        <source>no picture of this part</source>
        <translation>kein Bild dieses Teils</translation>
    </message>
    <message>
        <source>defect map</source>
        <translation>Fehlerkarte</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>no picture yet</source>
        <translation>noch kein Bild</translation>
    </message>
</context>
<context>
    <name>login</name>
    <message>
        <source>Log in</source>
        <translation>Anmelden</translation>
    </message>
    <message>
        <source>Log out</source>
        <translation>Abmelden</translation>
    </message>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>PIN</source>
        <translation>PIN</translation>
    </message>
    <message>
        <source>nobody is logged in</source>
        <translation>niemand ist angemeldet</translation>
    </message>
    <message>
        <source>Become administrator</source>
        <translation>Administrator werden</translation>
    </message>
    <message>
        <source>Nobody is known yet: whoever gives a name and a PIN of at least 4 digits becomes administrator.</source>
        <translation>Noch ist niemand bekannt: Wer einen Namen und eine PIN von mindestens 4 Ziffern angibt, wird Administrator.</translation>
    </message>
    <message>
        <source>Watching needs no login, doing does. Five wrong PINs lock a name for a minute.</source>
        <translation>Zusehen geht ohne Anmeldung, alles andere nicht. Fünf falsche PINs sperren einen Namen für eine Minute.</translation>
    </message>
    <message>
        <source>locked for a minute after five wrong PINs</source>
        <translation>nach fünf falschen PINs für eine Minute gesperrt</translation>
    </message>
</context>
<context>
    <name>masters</name>
    <message>
        <source>master</source>
        <translation>Meisterteil</translation>
    </message>
    <message>
        <source>must be</source>
        <translation>muss sein</translation>
    </message>
    <message>
        <source>was judged</source>
        <translation>wurde beurteilt</translation>
    </message>
    <message>
        <source>last check</source>
        <translation>letzte Prüfung</translation>
    </message>
    <message>
        <source>due</source>
        <translation>fällig</translation>
    </message>
    <message>
        <source>state</source>
        <translation>Stand</translation>
    </message>
    <message>
        <source>time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>Judge the chosen master</source>
        <translation>Gewähltes Meisterteil prüfen</translation>
    </message>
    <message>
        <source>Put the master in, choose it, judge it. The PLC can ask for it too (GOLDEN_CHECK).</source>
        <translation>Meisterteil einlegen, wählen, prüfen. Auch die SPS kann danach fragen (GOLDEN_CHECK).</translation>
    </message>
    <message>
        <source>masters</source>
        <translation>Meisterteile</translation>
    </message>
    <message>
        <source>log of the checks</source>
        <translation>Protokoll der Prüfungen</translation>
    </message>
    <message>
        <source>WRONG</source>
        <translation>FALSCH</translation>
    </message>
    <message>
        <source>DUE</source>
        <translation>FÄLLIG</translation>
    </message>
    <message>
        <source>no masters are named; write [golden.masters] into the settings file</source>
        <translation>keine Meisterteile genannt; [golden.masters] in die Einstellungsdatei schreiben</translation>
    </message>
    <message>
        <source>log in as setter to judge</source>
        <translation>zum Prüfen als Einrichter anmelden</translation>
    </message>
    <message>
        <source>choose a master first</source>
        <translation>erst ein Meisterteil wählen</translation>
    </message>
</context>
<context>
    <name>people</name>
    <message>
        <source>name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>level</source>
        <translation>Stufe</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>PIN, 4 to 12 digits</source>
        <translation>PIN, 4 bis 12 Ziffern</translation>
    </message>
    <message>
        <source>add or change</source>
        <translation>anlegen oder ändern</translation>
    </message>
    <message>
        <source>operator: reviews · setter: camera, service mode, masters · quality: limits of the recipes · administrator: users.
Each may do what the ones before may.</source>
        <translation>Bediener: Nachprüfung · Einrichter: Kamera, Service-Betrieb, Meisterteile · Qualität: Grenzen der Rezepte · Administrator: Benutzer.
Jede Stufe darf, was die davor dürfen.</translation>
    </message>
    <message>
        <source>known users</source>
        <translation>bekannte Benutzer</translation>
    </message>
    <message>
        <source>log in as administrator first</source>
        <translation>erst als Administrator anmelden</translation>
    </message>
    <message>
        <source>Really remove?</source>
        <translation>Wirklich entfernen?</translation>
    </message>
</context>
<context>
    <name>recipe</name>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>{kind}: threshold</source>
        <translation>{kind}: Schwelle</translation>
    </message>
    <message>
        <source>{kind}: minimum length (mm)</source>
        <translation>{kind}: Mindestlänge (mm)</translation>
    </message>
    <message>
        <source>least brightness</source>
        <translation>kleinste Helligkeit</translation>
    </message>
    <message>
        <source>greatest dark share</source>
        <translation>größter dunkler Anteil</translation>
    </message>
    <message>
        <source>greatest saturated share</source>
        <translation>größter übersteuerter Anteil</translation>
    </message>
    <message>
        <source>least sharpness</source>
        <translation>kleinste Schärfe</translation>
    </message>
    <message>
        <source>part</source>
        <translation>Teil</translation>
    </message>
    <message>
        <source>serial</source>
        <translation>Seriennummer</translation>
    </message>
    <message>
        <source>was</source>
        <translation>war</translation>
    </message>
    <message>
        <source>would be</source>
        <translation>wäre</translation>
    </message>
    <message>
        <source>segment</source>
        <translation>Segment</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>What if?</source>
        <translation>Was wäre wenn?</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>reason (needed)</source>
        <translation>Grund (nötig)</translation>
    </message>
    <message>
        <source>limits of single segments</source>
        <translation>Grenzen einzelner Segmente</translation>
    </message>
    <message>
        <source>would be released (NOK → OK): possible escapes</source>
        <translation>würden freigegeben (NOK → OK): möglicher Durchschlupf</translation>
    </message>
    <message>
        <source>would be refused (OK → NOK): possible false calls</source>
        <translation>würden gesperrt (OK → NOK): möglicher Fehlalarm</translation>
    </message>
    <message>
        <source>limits</source>
        <translation>Grenzen</translation>
    </message>
    <message>
        <source>log in as quality to save</source>
        <translation>zum Speichern als Qualität anmelden</translation>
    </message>
    <message>
        <source>ask what if before saving</source>
        <translation>vor dem Speichern „Was wäre wenn?“ fragen</translation>
    </message>
    <message>
        <source>a reason is needed</source>
        <translation>ein Grund ist nötig</translation>
    </message>
    <message>
        <source>scoring the archive again</source>
        <translation>Archiv wird neu bewertet</translation>
    </message>
    <message>
        <source>{n} parts: {released} would be released, {refused} refused</source>
        <translation>{n} Teile: {released} würden freigegeben, {refused} gesperrt</translation>
    </message>
    <message>
        <source>{n} parts that were too poor would be judged: nobody knows how</source>
        <translation>{n} bisher zu schlechte Bilder würden beurteilt: niemand weiß, wie</translation>
    </message>
    <message>
        <source>no part of this recipe in the archive: nobody knows what the limits do</source>
        <translation>kein Teil dieses Rezepts im Archiv: niemand weiß, was die Grenzen bewirken</translation>
    </message>
    <message>
        <source>{n} parts of another model, or unreadable, were left out</source>
        <translation>{n} Teile eines anderen Modells oder unlesbare blieben außer Betracht</translation>
    </message>
    <message>
        <source>waiting for the engine</source>
        <translation>wartet auf die Prüfung</translation>
    </message>
    <message>
        <source>saved and in use</source>
        <translation>gespeichert und in Gebrauch</translation>
    </message>
    <message>
        <source>nothing was changed:</source>
        <translation>nichts wurde geändert:</translation>
    </message>
</context>
<context>
    <name>replay</name>
    <message>
        <source>the newest of this station:</source>
        <translation>die neuesten dieser Station:</translation>
    </message>
    <message>
        <source>a folder or another archive:</source>
        <translation>ein Ordner oder ein anderes Archiv:</translation>
    </message>
    <message>
        <source>Choose…</source>
        <translation>Wählen…</translation>
    </message>
    <message>
        <source>folder with images</source>
        <translation>Ordner mit Bildern</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>Judge</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Report…</source>
        <translation>Bericht…</translation>
    </message>
    <message>
        <source>Flipped verdicts only</source>
        <translation>Nur geänderte Urteile</translation>
    </message>
    <message>
        <source>scale of the images</source>
        <translation>Maßstab der Bilder</translation>
    </message>
    <message>
        <source>image</source>
        <translation>Bild</translation>
    </message>
    <message>
        <source>on the line</source>
        <translation>an der Linie</translation>
    </message>
    <message>
        <source>now</source>
        <translation>jetzt</translation>
    </message>
    <message>
        <source>score</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>reason</source>
        <translation>Grund</translation>
    </message>
    <message>
        <source>images</source>
        <translation>Bilder</translation>
    </message>
    <message>
        <source>log in first (page Setup)</source>
        <translation>erst anmelden (Seite Einrichten)</translation>
    </message>
    <message>
        <source>the scale must be 1 to 200 µm/px</source>
        <translation>der Maßstab muss 1 bis 200 µm/px sein</translation>
    </message>
    <message>
        <source>choose a folder first</source>
        <translation>erst einen Ordner wählen</translation>
    </message>
    <message>
        <source>images are judged</source>
        <translation>Bilder werden geprüft</translation>
    </message>
    <message>
        <source>{n} images: {ok} OK, {nok} NOK, {error} not judged</source>
        <translation>{n} Bilder: {ok} OK, {nok} NOK, {error} nicht beurteilt</translation>
    </message>
    <message>
        <source>{n} compared with the line, {flips} verdicts differ</source>
        <translation>{n} mit der Linie verglichen, {flips} Urteile anders</translation>
    </message>
    <message>
        <source>differs from its record, although networks and limits are the same</source>
        <translation>weicht von seinem Datensatz ab, obwohl Netze und Grenzen dieselben sind</translation>
    </message>
    <message>
        <source>and {n} more</source>
        <translation>und {n} weitere</translation>
    </message>
    <message>
        <source>folder for the report</source>
        <translation>Ordner für den Bericht</translation>
    </message>
    <message>
        <source>report</source>
        <translation>Bericht</translation>
    </message>
</context>
<context>
    <name>setup</name>
    <message>
        <source>Login</source>
        <translation>Anmeldung</translation>
    </message>
    <message>
        <source>Camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>Recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>Masters</source>
        <translation>Meisterteile</translation>
    </message>
    <message>
        <source>Users</source>
        <translation>Benutzer</translation>
    </message>
    <message>
        <source>Journal</source>
        <translation>Journal</translation>
    </message>
</context>
<context>
    <name>statistics</name>
    <message>
        <source>shift</source>
        <translation>Schicht</translation>
    </message>
    <message>
        <source>recipe</source>
        <translation>Rezept</translation>
    </message>
    <message>
        <source>not judged</source>
        <translation>ungeprüft</translation>
    </message>
    <message>
        <source>yield</source>
        <translation>Ausbeute</translation>
    </message>
    <message>
        <source>the last</source>
        <translation>die letzten</translation>
    </message>
    <message>
        <source>Read again</source>
        <translation>Neu lesen</translation>
    </message>
    <message>
        <source>Report…</source>
        <translation>Bericht…</translation>
    </message>
    <message>
        <source>Counters to 0</source>
        <translation>Zähler auf 0</translation>
    </message>
    <message>
        <source>the counters of the page Live and of the PLC; noted in the journal</source>
        <translation>die Zähler der Seite Live und der SPS; wird im Journal vermerkt</translation>
    </message>
    <message>
        <source>reasons</source>
        <translation>Gründe</translation>
    </message>
    <message>
        <source>worst score of each part</source>
        <translation>schlechtester Wert je Teil</translation>
    </message>
    <message>
        <source>mean brightness</source>
        <translation>mittlere Helligkeit</translation>
    </message>
    <message>
        <source>grey levels</source>
        <translation>Graustufen</translation>
    </message>
    <message>
        <source>sharpness</source>
        <translation>Schärfe</translation>
    </message>
    <message>
        <source>saturated fraction</source>
        <translation>übersteuerter Anteil</translation>
    </message>
    <message>
        <source>distance to the training images</source>
        <translation>Abstand zu den Trainingsbildern</translation>
    </message>
    <message>
        <source>inspection time</source>
        <translation>Prüfdauer</translation>
    </message>
    <message>
        <source>shifts and recipes</source>
        <translation>Schichten und Rezepte</translation>
    </message>
    <message>
        <source>NOK segments by angle</source>
        <translation>NOK-Segmente nach Winkel</translation>
    </message>
    <message>
        <source>log in first (page Setup)</source>
        <translation>erst anmelden (Seite Einrichten)</translation>
    </message>
    <message>
        <source>reading records</source>
        <translation>Datensätze werden gelesen</translation>
    </message>
    <message>
        <source>no parts yet</source>
        <translation>noch keine Teile</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Bericht</translation>
    </message>
    <message>
        <source>report</source>
        <translation>Bericht</translation>
    </message>
</context>
<context>
    <name>window</name>
    <message>
        <source>Live</source>
        <translation>Live</translation>
    </message>
    <message>
        <source>History</source>
        <translation>Verlauf</translation>
    </message>
    <message>
        <source>Statistics</source>
        <translation>Statistik</translation>
    </message>
    <message>
        <source>Line</source>
        <translation>Linie</translation>
    </message>
    <message>
        <source>Alarms</source>
        <translation>Alarme</translation>
    </message>
    <message>
        <source>Setup</source>
        <translation>Einrichten</translation>
    </message>
    <message>
        <source>Replay</source>
        <translation>Wiedergabe</translation>
    </message>
    <message>
        <source>dark or light</source>
        <translation>dunkel oder hell</translation>
    </message>
    <message>
        <source>keys on the screen</source>
        <translation>Tasten auf dem Bildschirm</translation>
    </message>
    <message>
        <source>SIMULATED CAMERA</source>
        <translation>SIMULIERTE KAMERA</translation>
    </message>
    <message>
        <source>REPLAY</source>
        <translation>WIEDERGABE</translation>
    </message>
    <message>
        <source>no connection to the engine; the window reconnects automatically</source>
        <translation>keine Verbindung zur Prüfung; das Fenster verbindet sich von selbst wieder</translation>
    </message>
    <message>
        <source>Log in</source>
        <translation>Anmelden</translation>
    </message>
</context>
<context>
    <name>work</name>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>something is still being done: wait for it or cancel it</source>
        <translation>es läuft noch etwas: abwarten oder abbrechen</translation>
    </message>
</context>
</TS>
