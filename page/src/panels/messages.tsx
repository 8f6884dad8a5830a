import { useEffect, useState } from "preact/hooks";
import type { Message } from "../app/editor";
import type { Page } from "../app/page";
import { sentence } from "../app/wording";
import { Button, IconButton } from "./ui/button";
import { Icon } from "./ui/icon";

/**
 * The messages to the user: problem, location and remedy, until the user closes them. Messages of success disappear by
 * themselves. The newest is at the bottom.
 */
export function Messages({ page }: { page: Page }) {
  const { editor } = page;
  const messages = editor.messages.value;
  return (
    <div class="messages" data-homes="right left" role="log" aria-label="Messages">
      {messages.length > 2 && (
        <button
          type="button"
          class="button quiet"
          onClick={() => messages.forEach(({ key }) => editor.dismiss(key))}
        >
          Close all {messages.length}
        </button>
      )}
      {messages.map((message) => (
        <Toast key={message.key} message={message} onClose={() => editor.dismiss(message.key)} />
      ))}
    </div>
  );
}

const passingMs = 10_000; // for messages of success; all others stay

function Toast({ message: { kind, told, offer }, onClose }: { message: Message; onClose: () => void }) {
  const [copied, setCopied] = useState(false);
  const [held, setHeld] = useState(false);
  const isPassing = kind === "note" && told.remedy === "" && !held;
  useEffect(() => {
    if (!isPassing) return undefined;
    const timer = setTimeout(onClose, passingMs);
    return () => clearTimeout(timer);
  }, [isPassing]);
  const copy = async () => {
    const lines = [told.problem, told.location, told.remedy].filter((line) => line !== "");
    await navigator.clipboard.writeText(lines.join("\n")).then(
      () => setCopied(true),
      () => setCopied(false),
    );
  };
  return (
    <div
      class={`toast ${kind}`}
      role={kind === "problem" ? "alert" : "status"}
      onPointerEnter={() => setHeld(true)}
      onFocusCapture={() => setHeld(true)}
    >
      <Icon name={kind === "problem" ? "warning" : "note"} />
      <div class="toast-text">
        <strong>{sentence(told.problem)}</strong>
        {told.location !== "" && <code>{told.location}</code>}
        {told.remedy !== "" && <p>{told.remedy}</p>}
        {offer !== undefined && (
          <Button
            label={offer.label}
            onClick={() => {
              onClose();
              offer.run();
            }}
          />
        )}
      </div>
      <div class="toast-buttons">
        <IconButton label="Close the message" icon="close" onClick={onClose} />
        <IconButton
          label={copied ? "Copied" : "Copy the message"}
          icon={copied ? "accept" : "copy"}
          onClick={() => void copy()}
        />
      </div>
    </div>
  );
}
